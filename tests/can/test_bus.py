"""A bus is looked at before the first motion: what is on it, and whether it keeps time."""

import time

import can
import numpy as np
import pytest

from spirob.can.bus import check, listen, open_bus
from spirob.can.drive import find_drive
from spirob.can.robot import CanRobot
from spirob.can_protocol import COMMAND_ID, decode_command
from spirob.cli.main import main
from spirob.emulator import EmulatedRobot
from spirob.emulator.machine import Machine
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.emulator.robot import serve
from spirob.errors import HardwareError
from tests.can.fake_drives import FakeDrives
from tests.can.fake_odrives import FakeODrives
from tests.can.stalls import steady

PATIENT_NS = 500_000_000


class Quiet:
    """A robot of plain Python in exact time, with feedback that a test can thin out."""

    overruns = 0

    def __init__(self, change=lambda k, frames: frames):
        from tests.trials.fake_robot import FakeRobot

        self.robot, self.change, self.k = FakeRobot(), change, 0

    def exchange(self, command):
        frames = self.change(self.k, self.robot.exchange(command))
        self.k += 1
        return frames


def test_a_good_bus_has_no_faults_but_those_of_this_computer():
    found = check(Quiet(), 0.5)
    assert found.cycles == 500
    assert found.lost == {"left": 0.0, "right": 0.0}
    assert found.delay["left"][0] == pytest.approx(0.9e-3)
    assert not [f for f in found.faults if "motor" in f]
    assert not found.skipped


def test_a_drive_in_voltage_mode_is_checked_at_zero_volts():
    quiet = Quiet()
    quiet.robot = EmulatedRobot(EmulatedRig(by_voltage=True), HiddenSettings("none"), 1)
    found = check(quiet, 0.3, find_drive("gm6020"))
    assert found.lost == {"left": 0.0, "right": 0.0}
    assert not quiet.robot.machine.state["volts"].any()
    quiet.robot.close()
    said = ("can", "check", "--interface", "virtual", "--drive", "gm6020", "--bitrate", "250000")
    assert main(list(said)) == 2


def test_lost_frames_are_counted_and_named():
    def thinned(k, frames):
        return [f for f in frames if f.arbitration_id != 0x202 or k % 10 not in (3, 4)]

    found = check(Quiet(thinned), 0.5)
    assert found.lost == {"left": 0.0, "right": pytest.approx(0.2)}
    assert found.longest == {"left": 0, "right": 2}
    assert "motor right: 20.0 % of the feedback never came" in found.faults[0]


def test_answers_on_the_edge_between_two_cycles_are_not_lost():
    random, held = np.random.default_rng(0), []

    def late(k, frames):
        now = [*held, *(f for f in frames if f.arbitration_id != 0x202)]
        held.clear()
        (held if random.random() < 0.5 else now).extend(
            f for f in frames if f.arbitration_id == 0x202
        )
        return sorted(now, key=lambda f: f.arbitration_id)

    found = check(Quiet(late), 0.5)
    assert found.longest["right"] == 1
    assert found.lost == {"left": 0.0, "right": 0.0}
    assert not [f for f in found.faults if "motor" in f]


def test_a_motor_that_never_answers_is_named():
    with pytest.raises(HardwareError, match="no feedback from motor left"):
        check(Quiet(lambda k, frames: [frames[0], frames[2]]), 0.1)


@pytest.mark.parametrize("kind", ["c620", "odrive"])
@steady
def test_only_zero_is_commanded_on_a_bus(kind):
    channel = f"check-{kind}"
    drive = None if kind == "c620" else find_drive(kind)
    with (FakeODrives if drive else FakeDrives)(channel) as drives:
        robot = CanRobot(open_bus("virtual", channel), silence_ns=PATIENT_NS, drive=drive)
        found = check(robot, 0.2, drive)
        robot.close()
        commands = drives.torques if drive else drives.commands
        assert drives.wait_for(lambda: len(commands) >= 300)  # the warm-up, the check, the end
    assert not robot.armed
    assert all(command == (0.0, 0.0) for command in commands)
    assert found.rate["left"] > 100


def test_what_is_on_a_bus_is_listed_with_what_it_may_be():
    channel = "listen"
    bus, other = open_bus("virtual", channel), can.Bus(interface="virtual", channel=channel)
    sent = ((0x201, False, 8), (0x201, False, 8), (9, False, 8), (7, True, 3))
    for number, extended, size in sent:
        other.send(can.Message(arbitration_id=number, data=bytes(size), is_extended_id=extended))
    heard = listen(bus, 0.1, [find_drive("odrive")])
    bus.shutdown()
    other.shutdown()
    told = [(h.number, h.frames, h.sizes, h.meaning) for h in heard]
    assert told == [
        (7, 1, (3,), ""),
        (9, 1, (8,), "odrive Axis0_Get_Encoder_Estimates"),
        (0x201, 2, (8,), "c620 feedback, left"),
    ]


@steady
def test_the_commands_scan_and_check(capsys):
    with FakeDrives("cli") as drives:
        asked = ["--interface", "virtual", "--channel", "cli", "--seconds", "0.2"]
        code = main(["can", "check", *asked])
        said = capsys.readouterr().out
        assert ("ready to be armed" in said) == (code == 0)
        assert "feedback frames/s" in said
        assert all(c == (0.0, 0.0) for c in drives.commands)
    quiet = ["--interface", "virtual", "--channel", "quiet", "--seconds", "0.2"]
    assert main(["can", "scan", *quiet]) == 0
    assert "nothing was heard in 0.2 s" in capsys.readouterr().out
    assert main(["can", "scan"]) == 0
    assert "virtual" in capsys.readouterr().out
    assert main(["can", "check"]) == 2
    assert "needs --interface" in capsys.readouterr().err
    assert main(["can", "scan", "--interface", "smoke", "--seconds", "1"]) == 2
    assert "no interface 'smoke'" in capsys.readouterr().err


def test_the_emulator_serves_a_bus_in_real_time_and_speaks_unasked():
    machine = Machine(EmulatedRig(), HiddenSettings("none"), 1)
    machine.cycle((0.0, 0.0))
    command = bytes([4, 0, 0, 0, 0, 0, 0, 0])
    seen = []
    cycle = machine.cycle
    with (
        can.Bus(interface="virtual", channel="service") as drives,
        can.Bus(interface="virtual", channel="service") as bus,
    ):

        def lived(currents):
            seen.append(currents)
            if len(seen) == 100:  # in the machine's own time, whatever the computer's does
                message = can.Message(arbitration_id=COMMAND_ID, data=command, is_extended_id=False)
                bus.send(message)
            return cycle(currents)

        machine.cycle = lived
        begin = time.monotonic()
        dropped = serve(drives, machine, 0.4)
        assert time.monotonic() - begin >= 0.4
        heard = 0
        while bus.recv(0) is not None:
            heard += 1
    assert heard == 2 * (len(seen) - dropped)
    assert 400 <= len(seen) <= 400 + dropped + 1
    asked = [currents == decode_command(command) for currents in seen]
    assert asked.index(True) == 100
    assert sum(asked) == 101  # then nobody had spoken for 100 ms
    assert seen[0] == seen[-1] == (0.0, 0.0)
