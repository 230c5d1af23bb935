"""What goes wrong on the bus ends at zero current or does no harm; nothing that arrived is lost."""

import numpy as np
import pytest

from spirob.can_protocol import encode_command
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.emulator.faults import kinds, wire_from
from spirob.errors import ConfigError
from spirob.robot import Scene
from tests.emulator.faults.outcomes import FAULTS, outcome

STOPS = {  # why, and how soon the current is zero [s]
    "silent motor": ("motor left: no feedback for 10 ms", 0.011),
    "bus off": ("motor left: no feedback for 10 ms", 0.011),
    "encoder stuck": ("motor left: encoder and speed disagree", 0.03),
    "encoder jump": ("motor left: encoder and speed disagree", 0.005),
    "feedback frozen": ("motor left: encoder and speed disagree", 0.03),
    "power dip 1 s": ("motor left: current is ", 0.3),
    "corrupted 10 %": ("motor", 0.6),
}
BIT_EQUAL = ("duplicated 10 %", "encoder wrap")  # of what the arm did, which no log need show


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return outcome("none", tmp_path_factory.mktemp("none")).trace


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_stops_the_trial_in_time_or_does_little(name, whole, tmp_path):
    found = outcome(name, tmp_path)
    assert found.handed == found.kept
    if name in STOPS:
        why, soon = STOPS[name]
        assert found.said.startswith(why)
        assert found.said.endswith("the current is zero")
        assert 0 <= found.safe <= soon
        assert found.trace.meta["stopped"] == found.said
        return
    assert found.said is None
    rows = min(len(found.trace), len(whole))
    assert rows == 1000
    apart = found.trace["left.displacement"] - whole["left.displacement"]
    assert np.abs(apart).max() < 5e-3  # a winch without power gives way by 2 mm in 20 ms
    assert np.abs(apart[-1]) < 5e-4
    if name in BIT_EQUAL:
        for channel in ("left.current", "right.current", "left.displacement", "left.command"):
            np.testing.assert_array_equal(found.trace[channel], whole[channel])


def test_what_was_lost_is_counted(tmp_path):
    counts = outcome("lost, burst of 8 ms", tmp_path).trace.meta["frames"]
    assert (counts["left.missing"], counts["right.missing"]) == (8, 8)
    counts = outcome("duplicated 10 %", tmp_path).trace.meta["frames"]
    assert 30 <= counts["left.duplicate"] <= 90


def frames_of(faults, trial="a", cycles=30):
    robot = EmulatedRobot(EmulatedRig(), HiddenSettings("none"), 1, faults)
    robot.prepare(Scene(), trial)
    found = [robot.exchange(encode_command((0.5, 0.1))) for _ in range(cycles)]
    robot.close()
    return found


def test_without_faults_and_with_idle_ones_the_bits_are_the_same():
    bare = frames_of([])
    idle = [{"kind": kind, "start": 1.0} for kind in kinds()]
    assert frames_of(idle) == bare


def test_the_same_seed_gives_the_same_faults_and_another_trial_others():
    faults = [{"kind": "lost", "probability": 0.5}]
    assert frames_of(faults) == frames_of(faults)
    assert frames_of(faults) != frames_of(faults, "b")


def test_late_frames_come_later_in_their_order_and_are_stamped_when_they_come():
    bare, late = frames_of([]), frames_of([{"kind": "late", "motor": "left", "delay": 0.003}])
    for k in range(10, 20):
        (mine,) = [f for f in late[k] if f.arbitration_id == 0x201]
        assert mine.data == bare[k - 3][1].data
        assert mine.stamp_ns == (k + 1) * 1_000_000
        assert [f for f in late[k] if f.arbitration_id == 0x202] == [bare[k][2]]


def test_an_overtaken_frame_follows_the_newer_one():
    bare = frames_of([])
    mixed = frames_of([{"kind": "out_of_order", "motor": "left", "probability": 0.3}])
    mine = [f.data for frames in mixed for f in frames if f.arbitration_id == 0x201]
    sent = [frames[1].data for frames in bare]
    assert set(mine) <= set(sent)
    assert len(mine) >= len(sent) - 1
    assert mine != sent
    swapped = [k for k, frames in enumerate(mixed) if len(frames) == 2]
    first = swapped[0]
    assert [f.data for f in mixed[first + 1] if f.arbitration_id == 0x201][-1] == sent[first]


def test_drives_stop_by_themselves_when_nobody_speaks_to_them():
    robot = EmulatedRobot(EmulatedRig(), HiddenSettings("none"), 1, [{"kind": "bus_off"}])
    robot.prepare(Scene())
    seen = []
    cycle = robot.machine.cycle
    robot.machine.cycle = lambda currents: seen.append(currents) or cycle(currents)
    robot._wire.cycle = lambda now: None  # the first command still passes
    robot.exchange(encode_command((0.5, 0.1)))
    del robot._wire.cycle
    for _ in range(150):
        assert len(robot.exchange(encode_command((0.5, 0.1)))) == 1
    robot.close()
    assert seen[100][0] == pytest.approx(0.5, abs=1e-3)
    assert seen[101:] == [(0.0, 0.0)] * 50


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"kind": "gremlins"}, "no fault 'gremlins'; known: bus_off, corrupted"),
        ({"kind": "lost", "motor": "middle"}, r"robot\.faults\[0\]: motor must be left, right"),
        ({"kind": "lost", "frames": "none"}, "frames must be feedback, command, both"),
        ({"kind": "lost", "probability": 2.0}, r"robot\.faults\[0\]: fault\.probability = 2"),
        ({"kind": "lost", "probability": "x"}, "probability must be a number, not 'x'"),
        ({"kind": "lost", "delay": 0.1}, "no number 'delay'; it has: start, duration"),
    ],
)
def test_a_mistake_in_a_fault_is_told_in_a_sentence(given, sentence):
    with pytest.raises(ConfigError, match=sentence):
        wire_from([given])
