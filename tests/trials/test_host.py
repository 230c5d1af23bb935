"""The whole way with the loop on the host: guard, law, bus, winding, log."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spirob.can.drive import find_drive
from spirob.can.limits import Limits, Stopped
from spirob.can_protocol import decode_volts, encode_command
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.errors import ConfigError, HardwareError
from spirob.experiments.host_loop import GainSet
from spirob.logs import Transmission, read_log
from spirob.plant import Plant, Rig
from spirob.robot import Scene
from spirob.trials import Trial, record
from spirob.trials.play import HostCurrentLoop, guard
from spirob.trials.simulation import SimulatedRobot, simulate
from tests.trials.trials import plain_trial

DRIVE = find_drive("gm6020")
RIG = Rig.from_mapping({"drive": {"loop": "host", "host": {"bandwidth": 20.0}}})
OPEN = {"travel": 10.0, "speed": 100.0, "temperature": 150.0, "following": 40.0, "frozen": 10.0}


class Seen:
    """An emulated robot in voltage mode that keeps what reached it, and may fall silent."""

    def __init__(self, seed=3, faults=(), **rig):
        self.robot = EmulatedRobot(
            EmulatedRig(by_voltage=True, **rig), HiddenSettings("none"), seed, faults
        )
        self.volts, self.mute = [], False

    def prepare(self, scene, trial="trial"):
        self.robot.prepare(scene, trial)

    def exchange(self, command):
        self.volts.append(decode_volts(command))
        frames = self.robot.exchange(command)
        return frames[:1] if self.mute else frames

    def close(self):
        self.robot.close()


def guarded(robot, rig=RIG, **limits):
    made = guard(
        robot, Transmission(), Limits(**limits), DRIVE, HostCurrentLoop.of(rig, Limits().voltage)
    )
    made.prepare(Scene())
    return made


def bend(seconds=1.0):
    smooth = {"kind": "sine", "amplitude": 0.2, "frequency": 2.0, "offset": 0.5, "blend": 0.2}
    motors = {
        "left": {"mode": "current", "current_limit": 5.0, "profile": smooth},
        "right": {
            "mode": "current",
            "current_limit": 5.0,
            "profile": {"kind": "constant", "value": 0.4, "blend": 0.2},
        },
    }
    plain = plain_trial(seconds, motors=motors)
    plain.pop("scene")
    return Trial.from_plain(plain)


def test_current_follows_its_command_and_the_log_holds_both(tmp_path):
    robot = Seen()
    path = record(
        bend(),
        robot,
        tmp_path / "t.mcap",
        RIG,
        drive=DRIVE,
        loop=HostCurrentLoop.of(RIG, 24.0),
    )
    robot.close()
    trace = read_log(path)
    assert "K_p" in trace.meta["about"]["host_loop"]
    assert trace.units["left.voltage"] == "V"
    for motor in ("left", "right"):
        error = trace[f"{motor}.current"] - trace[f"{motor}.command"]
        assert np.sqrt(np.mean(error[300:] ** 2)) < 0.02
        sent = np.array(robot.volts)[:, ("left", "right").index(motor)]
        assert set(trace[f"{motor}.voltage"]) <= set(sent)
    assert robot.volts[-1] == (0.0, 0.0)
    for motor in ("left", "right"):  # what the voltage is for: R i + k_e ω
        speed = trace[f"{motor}.velocity"] * RIG.winch.gear_ratio / RIG.winch.radius
        taken = RIG.motor.resistance * trace[f"{motor}.command"] + RIG.motor.emf_constant * speed
        assert np.abs(np.mean((trace[f"{motor}.voltage"] - taken)[300:])) < 0.01


@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    commands=st.lists(st.binary(min_size=8, max_size=8), min_size=1, max_size=25),
    voltage=st.floats(0.1, 24.0),
    slew=st.floats(20.0, 1e5),
)
def test_no_voltage_leaves_its_limits(commands, voltage, slew):
    robot = Seen()
    made = guarded(robot, **OPEN, current=20.0, voltage=voltage, voltage_slew=slew)
    made.exchange(encode_command((0.0, 0.0)))
    made.arm()
    try:
        for command in commands:
            made.exchange(command)
    except Stopped:
        assert robot.volts[-1] == (0.0, 0.0)
    seen = np.array([(0.0, 0.0), *robot.volts])
    assert np.abs(seen).max() <= voltage + 1e-9
    steps = np.abs(np.diff(seen, axis=0))[: len(robot.volts) - 1]
    assert steps.max(initial=0) <= max(slew * 1e-3, 0.00096) + 1e-9
    robot.close()


def test_disarmed_no_voltage_passes_and_none_to_motors_unheard():
    robot = Seen()
    made = guarded(robot)
    made.exchange(encode_command((0.0, 0.0)))
    with pytest.raises(HardwareError, match="not armed"):
        made.exchange(encode_command((0.1, 0.0)))
    robot.mute = True
    made = guarded(robot)
    made.arm()
    made.exchange(encode_command((0.5, 0.5)))
    assert not np.any(robot.volts)
    robot.close()


def test_silence_is_zero_volts_after_ten_milliseconds():
    robot = Seen()
    made = guarded(robot)
    made.arm()
    for _ in range(50):
        made.exchange(encode_command((0.5, 0.3)))
    robot.mute, first = True, len(robot.volts)
    with pytest.raises(Stopped, match="no feedback for 1"):
        for _ in range(20):
            made.exchange(encode_command((0.5, 0.3)))
    assert len(robot.volts) - first <= 11
    assert robot.volts[-1] == (0.0, 0.0)
    held = np.array(robot.volts[first + 1 : -1])
    assert np.ptp(held, axis=0).max() < 1e-9  # an old reading is not counted twice
    robot.close()


def test_a_current_beyond_what_may_be_asked_for_is_a_stop():
    # a wrong idea of the winding: the host believes ten times its resistance
    wrong = Rig.from_mapping(
        {"motor": {"resistance": 1.94}, "drive": {"loop": "host", "host": {"bandwidth": 1.0}}}
    )
    robot = Seen()
    made = guarded(robot, wrong, current=1.0, following=0.5, following_time=5.0)
    made.arm()
    with pytest.raises(Stopped, match=r"current is \+\d.* limit 1 A and 0.5 A more"):
        for _ in range(200):
            made.exchange(encode_command((0.9, 0.0)))
    assert robot.volts[-1] == (0.0, 0.0)
    robot.close()


@pytest.mark.parametrize("noise", [0.005, 0.0])
def test_a_current_that_is_read_no_more_does_not_run_away(noise):
    # frozen before the guard has seen a standing motor's noise, or of a drive that shows none
    frozen = {"kind": "feedback_frozen", "motor": "left", "start": 0.4}
    robot = Seen(seed=1, faults=[frozen], gear_ratio=1.0, current_noise=noise)
    made = guarded(robot, Rig.from_mapping(GainSet(20.0, 0.0, 1e-3).rig()))
    made.arm()
    true = []
    with pytest.raises(Stopped, match=r"motor left: .*10 ms after the voltage moved 0\.10 V"):
        for _ in range(20_000):
            made.exchange(encode_command((0.8, 0.8)))
            true.append(robot.robot.machine.state["current"][0, 0])
    assert robot.volts[-1] == (0.0, 0.0)
    assert np.abs(np.array(true) - 0.8)[400:].max() < 1.1 * 0.1 / RIG.motor.resistance
    robot.close()


def test_drive_and_loop_must_fit():
    with pytest.raises(ConfigError, match="drive 'c620' has no voltage mode"):
        guard(Seen(), Transmission(), None, None, HostCurrentLoop.of(RIG, 24.0))
    with pytest.raises(ConfigError, match="drive 'odrive' has no voltage mode"):
        guard(Seen(), Transmission(), None, find_drive("odrive"), HostCurrentLoop.of(RIG, 24.0))
    with pytest.raises(ConfigError, match=r"'gm6020' takes voltages: it needs rig\.drive"):
        guard(Seen(), Transmission(), None, DRIVE)
    assert HostCurrentLoop.of(Rig(), 24.0) is None


def test_the_simulated_robot_has_the_loop_inside(tmp_path):
    path = record(
        bend(0.4),
        SimulatedRobot(Plant(RIG)),
        tmp_path / "t.mcap",
        RIG,
    )
    same = simulate(Plant(RIG), bend(0.4), {})
    assert read_log(path)["left.current"][200:] == pytest.approx(
        same["left.current"][200:], abs=5e-3
    )
