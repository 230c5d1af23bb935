"""The robot as seen over the bus."""

import json

import numpy as np
import pytest

from spirob.can_protocol import decode_feedback, encode_command
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.emulator.hidden.guide_friction import TYPICAL
from spirob.errors import ConfigError, HardwareError
from spirob.logs import read_log
from spirob.robot import CYCLE_NS, MOTORS, Scene
from tests.trials.trials import record_on


def record(robot, trial, cycles=60, currents=(0.5, 0.1)):
    robot.prepare(Scene(), trial)
    return [robot.exchange(encode_command(currents)) for _ in range(cycles)]


@pytest.fixture
def robot():
    made = EmulatedRobot(EmulatedRig(), HiddenSettings(), seed=1)
    yield made
    made.close()


def test_each_command_is_answered_by_two_drives_at_the_end_of_its_cycle(robot):
    for k, frames in enumerate(record(robot, "a", 5)):
        assert [f.arbitration_id for f in frames] == [0x200, 0x201, 0x202]
        stamps = [f.stamp_ns for f in frames]
        assert stamps == [k * CYCLE_NS, (k + 1) * CYCLE_NS, (k + 1) * CYCLE_NS]


def test_the_command_acts_in_the_cycle_whose_end_the_feedback_tells(robot):
    robot.prepare(Scene(), "a")
    quiet = decode_feedback(robot.exchange(encode_command((0.0, 0.0)))[1].data)
    acting = decode_feedback(robot.exchange(encode_command((2.0, 0.0)))[1].data)
    assert abs(quiet.current) < 30
    assert acting.current > 1500


def test_angle_counts_wrap_at_8192_and_agree_with_the_speed(robot):
    frames = record(robot, "wrap", 800, (1.0, 0.1))
    told = [decode_feedback(f[1].data) for f in frames]
    angle = np.array([t.angle for t in told])
    assert angle.min() >= 0
    assert angle.max() <= 8191
    jumps = np.diff(angle)
    assert (jumps < -4096).sum() >= 3
    turned = np.unwrap(angle * 2 * np.pi / 8192)
    speed = np.array([t.speed for t in told]) * 2 * np.pi / 60
    assert turned[-1] - turned[0] == pytest.approx(1e-3 * speed[1:].sum(), rel=0.02)


def test_same_seed_same_bits_other_seed_other_robot(robot):
    twin = EmulatedRobot(EmulatedRig(), HiddenSettings(), seed=1)
    other = EmulatedRobot(EmulatedRig(), HiddenSettings(), seed=2)
    first = record(robot, "a")
    record(twin, "something before")
    assert record(twin, "a") == first
    assert record(other, "a") != first
    assert record(robot, "b") != first
    twin.close()
    other.close()


def test_parallel_robots_do_not_hear_each_other(robot):
    other = EmulatedRobot(EmulatedRig(), HiddenSettings("none"), seed=5)
    alone = record(robot, "a", 30)
    robot.prepare(Scene(), "a")
    other.prepare(Scene(), "a")
    together = []
    for _ in range(30):
        together.append(robot.exchange(encode_command((0.5, 0.1))))
        other.exchange(encode_command((3.0, -1.0)))
    assert together == alone
    other.close()


def test_truth_is_plain_data_and_holds_the_effect(robot):
    truth = json.loads(json.dumps(robot.truth()))
    assert truth["effect"] == "guide_friction"
    friction = np.array(truth["hidden"][0]["numbers"]["guide_friction"])
    assert TYPICAL / 2 < friction.mean() < 2 * TYPICAL
    assert np.ptp(friction) > 0
    assert 0.6 < truth["drawn"]["efficiency"][0] <= 1.0


def test_truth_stays_within_what_can_be_identified():
    from spirob.emulator.rig import draw

    for seed in range(300):
        drawn = draw(np.random.default_rng(seed))
        assert ((drawn["efficiency"] > 0.6) & (drawn["efficiency"] <= 1.0)).all()
        assert ((drawn["rotor_inertia"] > 5e-6) & (drawn["rotor_inertia"] < 5e-4)).all()
        assert ((drawn["rotor_damping"] > 1e-5) & (drawn["rotor_damping"] < 1e-3)).all()


def test_a_lost_state_is_an_error_and_never_a_count(robot):
    robot.prepare(Scene(), "a")
    robot.machine.state["rate"][0, 3] = np.nan
    before = robot.machine.counts.copy()
    with pytest.raises(HardwareError, match="non-finite"):
        robot.exchange(encode_command((0.1, 0.1)))
    assert np.array_equal(robot.machine.counts, before)
    record(robot, "again", 3)


def test_a_closed_robot_says_so_and_closes_twice():
    made = EmulatedRobot(seed=1)
    made.close()
    made.close()
    with pytest.raises(HardwareError, match="closed"):
        made.exchange(encode_command((0.0, 0.0)))


def test_wrong_settings_are_told_in_a_sentence():
    with pytest.raises(ConfigError, match="known: asymmetric_viscous"):
        EmulatedRobot(EmulatedRig(), HiddenSettings("gremlins"), seed=0)
    with pytest.raises(ConfigError, match="gear_ratio"):
        EmulatedRig(gear_ratio=0.1)


def test_a_log_tells_where_in_a_turn_the_rotors_stood(robot, tmp_path):
    """Else no ripple over the angle has the same phase in two trials."""
    log = record_on(robot, tmp_path, scene={})
    told = read_log(log).meta["first_angle"]
    start = robot.machine.state["rotor_start"][0]
    assert [told[motor] for motor in MOTORS] == pytest.approx(start, abs=2e-3)
    assert start.min() > 0.1  # a zero would prove nothing
