"""The robot on a bus keeps time, and commands zero before it complains."""

import sys
import time

import can
import pytest

from spirob.can.bus import open_bus
from spirob.can.limits import Limits
from spirob.can.robot import CanRobot, Urgency
from spirob.can_protocol import COMMAND_ID, encode_command
from spirob.emulator.__main__ import main as serve
from spirob.errors import HardwareError
from spirob.logs import read_log
from spirob.plant import Rig
from spirob.robot import CYCLE_NS, MOTORS, Cylinder, Scene
from spirob.trials import Trial, record
from tests.can.fake_drives import FakeDrives
from tests.can.stalls import steady
from tests.trials.trials import plain_trial

HALF_AMPERE = encode_command((0.5, 0.25))
PATIENT_NS = 200_000_000  # a loaded machine may hold up the drives' thread for a while


@pytest.fixture
def channel(request):
    return f"test-{request.node.name}"


def agree(question):
    return "arm"


def ready(channel, **options):
    robot = CanRobot(open_bus("virtual", channel), ask=agree, **options)
    robot.prepare(Scene())
    robot.arm()
    return robot


@steady
def test_a_cycle_returns_the_command_and_the_feedback(channel):
    with FakeDrives(channel) as drives:
        robot = ready(channel, silence_ns=PATIENT_NS)
        cycles = [robot.exchange(HALF_AMPERE) for _ in range(50)]
        robot.close()
        assert drives.wait_for(lambda: len(drives.commands) >= 52)
    assert all(frames[0].arbitration_id == COMMAND_ID for frames in cycles)
    assert all(frames[0].data == HALF_AMPERE for frames in cycles)
    heard = {f.arbitration_id for frames in cycles for f in frames[1:]}
    assert heard == {0x201, 0x202}
    stamps = [f.stamp_ns for frames in cycles for f in frames]
    assert stamps == sorted(stamps)


@steady
def test_cycles_keep_to_their_deadlines(channel):
    with FakeDrives(channel):
        robot = ready(channel, silence_ns=PATIENT_NS)
        robot.exchange(HALF_AMPERE)
        first, skipped = robot._deadline, robot.overruns
        for _ in range(200):
            robot.exchange(HALF_AMPERE)
        now, last, overruns = time.monotonic_ns(), robot._deadline, robot.overruns - skipped
        timing = robot.timing()
        robot.close()
    # Lateness of single cycles does not add up: the last ends a whole number of cycles on.
    assert last - first == (200 + overruns) * CYCLE_NS
    assert last <= now
    assert timing["cycles"] == "201"
    assert float(timing["lateness_p50_us"]) < 1e-3 * CYCLE_NS


@steady
def test_what_the_start_takes_is_no_skipped_cycle(channel, monkeypatch):
    monkeypatch.setattr(Urgency, "take", lambda self: time.sleep(0.05))
    with FakeDrives(channel):
        robot = ready(channel, silence_ns=PATIENT_NS, urgent=True)
        robot.exchange(HALF_AMPERE)
        skipped = robot.overruns
        robot.close()
    assert skipped == 0


@pytest.mark.parametrize("motor", MOTORS)
@steady
def test_a_silent_drive_is_named_after_zero_was_commanded(channel, motor):
    with FakeDrives(channel, mute=[motor]) as drives:
        robot = ready(channel, silence_ns=PATIENT_NS)
        with pytest.raises(HardwareError, match=f"motor {motor} for .* ms"):
            for _ in range(2000):
                robot.exchange(HALF_AMPERE)
        assert drives.wait_for(lambda: drives.commands[-1:] == [(0.0, 0.0)])
        robot.close()


def test_ten_milliseconds_of_silence_are_enough(channel):
    robot = ready(channel)  # nobody else is on the bus
    start = time.monotonic()
    with pytest.raises(HardwareError, match="motor left"):
        for _ in range(100):
            robot.exchange(HALF_AMPERE)
    assert time.monotonic() - start >= 0.010
    robot.close()


@steady
def test_closing_commands_zero_and_can_be_repeated(channel):
    with FakeDrives(channel) as drives:
        robot = ready(channel, silence_ns=PATIENT_NS)
        robot.exchange(HALF_AMPERE)
        robot.close()
        robot.close()
        assert drives.wait_for(lambda: drives.commands[-1:] == [(0.0, 0.0)])


def test_a_dead_bus_is_a_hardware_error(channel):
    bus = open_bus("virtual", channel)
    robot = CanRobot(bus, ask=agree)
    bus.shutdown()
    with pytest.raises(HardwareError, match="closed bus"):
        robot.exchange(bytes(8))


@steady
def test_no_current_flows_before_the_operator_has_armed(channel):
    answers = iter(["", "no", " ARM "])
    with FakeDrives(channel) as drives:
        robot = CanRobot(
            open_bus("virtual", channel), silence_ns=PATIENT_NS, ask=lambda text: next(answers)
        )
        robot.prepare(Scene())
        with pytest.raises(HardwareError, match="not armed"):
            robot.exchange(HALF_AMPERE)
        with pytest.raises(HardwareError, match="was not armed"):
            robot.arm()
        assert all(command == (0.0, 0.0) for command in drives.commands)
        robot.arm()
        robot.exchange(HALF_AMPERE)
        assert drives.wait_for(lambda: any(c[0] > 0.4 for c in drives.commands))
        robot.close()


def test_the_operator_is_told_what_to_set_up(channel):
    asked = []
    robot = CanRobot(open_bus("virtual", channel), ask=asked.append)
    robot.prepare(Scene(Cylinder(diameter=0.04, x=0.29, y=0.03)))
    robot.close()
    assert "cylinder of 40.0 mm" in asked[0]


@steady
def test_a_trial_is_recorded_over_a_bus(channel, tmp_path):
    motors = plain_trial()["motors"]
    motors["left"] = dict(motors["right"])
    trial = Trial.from_plain(plain_trial(0.3, motors=motors))
    with FakeDrives(channel) as drives:
        robot = CanRobot(open_bus("virtual", channel), silence_ns=PATIENT_NS, ask=agree)
        path = record(
            trial,
            robot,
            tmp_path / "t.mcap",
            Rig(),
            limits=Limits(silence=1e-9 * PATIENT_NS),
        )
        robot.close()
        assert drives.wait_for(lambda: drives.commands[-1:] == [(0.0, 0.0)])
    trace = read_log(path)
    assert len(trace) >= 300 - 1  # jitter may put two commands into one cycle
    assert trace["left.displacement"][-1] > 0


def test_an_unknown_interface_lists_the_known_ones():
    with pytest.raises(HardwareError, match=r"no interface 'smoke'; known: .*pcan.*socketcan"):
        open_bus("smoke", "0")


@pytest.mark.parametrize(
    ("interface", "module", "package"),
    [("udp_multicast", "msgpack", "msgpack"), ("slcan", "serial", "pyserial")],
)
def test_the_library_that_an_interface_lacks_is_named(monkeypatch, interface, module, package):
    monkeypatch.setitem(sys.modules, module, None)  # as if it were not installed
    with pytest.raises(HardwareError, match=rf"{interface} needs {package}.*\[can\]"):
        open_bus(interface, "239.74.163.2")


def test_the_emulator_names_it_too(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "msgpack", None)
    assert serve(["--interface", "udp_multicast"]) == 2
    assert "needs msgpack, which is not installed" in capsys.readouterr().err


def test_a_bus_that_cannot_be_opened_is_named():
    with pytest.raises(HardwareError, match=r"CAN bus socketcan:nowhere9 cannot be opened"):
        open_bus("socketcan", "nowhere9")


@steady
def test_frames_of_other_kinds_are_passed_over(channel):
    other = can.Bus(interface="virtual", channel=channel)
    with FakeDrives(channel):
        robot = ready(channel, silence_ns=PATIENT_NS)
        robot.exchange(HALF_AMPERE)
        other.send(can.Message(arbitration_id=0x1ABCDE, data=b"x", is_extended_id=True))
        other.send(can.Message(arbitration_id=0x201, is_remote_frame=True, is_extended_id=False))
        frames = [f for _ in range(20) for f in robot.exchange(HALF_AMPERE)]
        robot.close()
    other.shutdown()
    assert {f.arbitration_id for f in frames} == {0x200, 0x201, 0x202}
    assert all(len(f.data) == 8 for f in frames)
