"""Whatever is asked for, on whatever path: the drives see only what the limits allow."""

import struct

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spirob.can.guard import GuardedRobot
from spirob.can.limits import Limits, Stopped
from spirob.can_protocol import AMPERE_PER_COUNT, CanFrame, encode_command
from spirob.errors import ConfigError, HardwareError
from spirob.robot import CYCLE_NS, Scene
from tests.can.paths import PATHS
from tests.can.stalls import steady
from tests.trials.fake_robot import FakeRobot

COMMANDS = st.lists(st.binary(min_size=8, max_size=8), min_size=1, max_size=25)
OPEN = {"travel": 10.0, "speed": 100.0, "temperature": 150.0, "silence": 1.0}
OPEN |= {"following": 40.0, "frozen": 10.0}


def guarded(robot, keep=lambda frames: None, **limits):
    made = GuardedRobot(robot, Limits(**limits), 8e-7, 1.1e-4, keep)
    made.prepare(Scene())
    return made


@pytest.mark.parametrize("path", PATHS)
@steady
def test_no_command_leaves_current_and_slew(path):
    with PATHS[path]() as (robot, sent):

        @settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
        @given(
            commands=COMMANDS,
            current=st.floats(0.05, 20.0),
            slew=st.floats(10.0, 1e5),
        )
        def holds(commands, current, slew):
            guard = guarded(robot, **OPEN, current=current, slew=slew)
            guard.arm()
            first = len(sent)
            for command in commands:
                guard.exchange(command)
            guard.stop()
            seen = np.array([(0.0, 0.0), *sent[first:]])
            count = AMPERE_PER_COUNT
            assert np.abs(seen).max() <= current + 1e-9
            allowed = max(slew * 1e-3, count) + 1e-9
            assert np.abs(np.diff(seen[:-1], axis=0)).max(initial=0) <= allowed

        holds()


@settings(max_examples=100, deadline=None)
@given(commands=COMMANDS)
def test_wide_limits_change_no_bit(commands):
    class Keeps(FakeRobot):
        def exchange(self, command):
            self.seen = [*getattr(self, "seen", []), command]
            return super().exchange(command)

    robot = Keeps()
    guard = guarded(robot, **OPEN, slew=1e6)
    guard.arm()
    within = [
        struct.pack(">4h", *(max(-16384, min(16384, c)) for c in struct.unpack(">4h", b)[:2]), 0, 0)
        for b in commands
    ]
    for command in within:
        guard.exchange(command)
    assert robot.seen == within


@settings(max_examples=100, deadline=None)
@given(
    commands=COMMANDS,
    fail_at=st.integers(1, 25),
    error=st.sampled_from([HardwareError("gone"), OSError(28, "full"), KeyboardInterrupt()]),
    where=st.sampled_from(["robot", "keep"]),
)
def test_after_any_failure_zero_is_sent_and_nothing_else_until_armed(
    commands, fail_at, error, where
):
    def keep(frames):
        if where == "keep" and len(robot.commands) == fail_at:
            raise error

    robot = FakeRobot(fail_at if where == "robot" else None, error)
    guard = guarded(robot, keep, **OPEN)
    guard.arm()
    try:
        for command in commands:
            guard.exchange(command)
    except BaseException as raised:
        assert raised is error
        assert robot.commands[-1] == (0.0, 0.0)
        assert not guard.armed
        with pytest.raises(HardwareError, match="not armed"):
            guard.exchange(encode_command((0.1, 0.0)))
        assert all(c == (0.0, 0.0) for c in robot.commands[fail_at:])
    else:
        assert len(commands) < fail_at


@pytest.mark.parametrize("path", PATHS)
@steady
def test_disarmed_only_zero_passes(path):
    with PATHS[path]() as (robot, sent):
        guard = guarded(robot)
        guard.exchange(encode_command((0.0, 0.0)))
        with pytest.raises(HardwareError, match="not armed"):
            guard.exchange(encode_command((0.0, -0.01)))
        assert not np.any(sent)
        guard.arm()
        guard.exchange(encode_command((0.5, 0.0)))
        guard.prepare(Scene())
        with pytest.raises(HardwareError, match="not armed"):
            guard.exchange(encode_command((0.5, 0.0)))


class Faulty(FakeRobot):
    """Feedback that a test can change."""

    def __init__(self, change):
        super().__init__()
        self.change = change

    def exchange(self, command):
        return self.change(len(self.commands), super().exchange(command))


def feedback(motor, stamp, angle=0, speed=0, current=0, temperature=25):
    data = struct.pack(">HhhBx", angle % 8192, speed, current, temperature)
    return CanFrame(stamp, 0x201 + motor, data)


def stopped_by(change, commands=None, **limits):
    """The sentence and the cycle of the stop; every frame of the last cycle was kept."""
    robot, kept = Faulty(change), []
    guard = guarded(robot, kept.extend, **limits)
    guard.arm()
    with pytest.raises(Stopped) as caught:
        for k in range(2000):
            guard.exchange(commands(k) if commands else encode_command((0.2, 0.2)))
    assert robot.commands[-1] == (0.0, 0.0)
    assert len(robot.commands) == len([f for f in kept if f.arbitration_id == 0x200])
    return str(caught.value), len(robot.commands) - 2  # the last one is the zero


@pytest.mark.parametrize("motor", [0, 1])
def test_ten_milliseconds_of_silence_name_the_motor(motor):
    said, cycle = stopped_by(
        lambda k, frames: (
            frames if k < 50 else [f for f in frames if f.arbitration_id != 0x201 + motor]
        )
    )
    assert said.startswith(f"motor {('left', 'right')[motor]}: no feedback for 10 ms")
    assert cycle == 59


def test_too_hot_too_fast_too_far_are_named():
    def hot(k, frames):
        return [*frames[:2], feedback(1, frames[0].stamp_ns + CYCLE_NS, temperature=25 + k)]

    assert stopped_by(hot, frozen=10.0, following=40.0, temperature=80.0) == (
        "motor right: winding at 83 °C, limit 80 °C; the current is zero",
        58,
    )
    said, _ = stopped_by(lambda k, frames: frames, speed=0.005)
    assert "motor left: tendon at 0.005 m/s, limit 0.005 m/s" in said
    said, _ = stopped_by(lambda k, frames: frames, travel=0.002)
    assert "motor left: tendon at 2.0 mm, limit 2 mm" in said


def test_one_bad_frame_stops_nothing():
    def once(k, frames):
        if k == 30:
            stamp = frames[0].stamp_ns + CYCLE_NS
            return [frames[0], feedback(0, stamp, 4000, 30000, -9000, 140), frames[2]]
        return frames

    guard = guarded(Faulty(once), speed=0.5, temperature=80.0)
    guard.arm()
    for _ in range(400):
        guard.exchange(encode_command((0.2, 0.2)))


def test_an_encoder_that_jumps_or_sticks_is_named():
    def jumps(k, frames):
        stamp = frames[0].stamp_ns + CYCLE_NS
        return [*frames[:2], feedback(1, stamp, 3000 * (k >= 40), 0, 163, 25)]

    said, cycle = stopped_by(jumps, frozen=10.0)
    assert "motor right: encoder and speed disagree by +0.36 turns" in said
    assert cycle == 42

    def sticks(k, frames):
        stamp = frames[0].stamp_ns + CYCLE_NS
        return [*frames[:2], feedback(1, stamp, 700, 450, 163, 25)]

    assert "motor right: encoder and speed disagree" in stopped_by(sticks, frozen=10.0)[0]


def test_a_drive_that_does_not_follow_is_named():
    said, cycle = stopped_by(
        lambda k, frames: [
            *frames[:2],
            feedback(1, frames[0].stamp_ns + CYCLE_NS, temperature=k % 9),
        ],
        lambda k: encode_command((0.2, 2.0)),
    )
    assert "motor right: current is +2.00 A from the command for 25" in said
    assert 250 <= cycle <= 254


def test_the_same_feedback_for_ever_is_no_feedback():
    said, cycle = stopped_by(
        lambda k, frames: [*frames[:2], feedback(1, frames[0].stamp_ns + CYCLE_NS)],
        lambda k: encode_command((0.2, 0.01 * k)),
    )
    assert "motor right: the same feedback for" in said
    assert 50 <= cycle <= 56


def test_limits_are_checked():
    with pytest.raises(ConfigError, match=r"safety\.current = 30"):
        Limits(current=30.0)
    with pytest.raises(ConfigError, match="safety has no number 'volts'"):
        Limits.from_mapping({"volts": 3.0})
