"""The rehearsal for a laboratory: the emulator as a process of its own on a network bus."""

import subprocess
import sys
from pathlib import Path

import can
import pytest

from spirob.bench import Trial, record
from spirob.canbus import CanRobot, open_bus
from spirob.control.law import Gains
from spirob.errors import HardwareError
from spirob.logs import Transmission, read_log
from spirob.safety import Limits
from tests.bench.trials import plain_trial

CHANNEL = "239.74.163.77"
PATIENT = 0.9  # s: the machine that tests may stop a process for a while


@pytest.fixture
def emulator():
    asked = [sys.executable, "-m", "spirob.emulator", "--channel", CHANNEL, "--seconds", "30"]
    process = subprocess.Popen(
        asked, cwd=Path(__file__).parents[2], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    if b"serving" not in process.stdout.readline():
        pytest.skip(f"no multicast here: {process.communicate()[1].decode().strip()}")
    yield process
    process.kill()
    process.communicate()


def test_a_trial_is_recorded_from_another_process(emulator, tmp_path):
    try:
        bus = open_bus("udp_multicast", CHANNEL)
    except (HardwareError, can.CanError) as error:
        pytest.skip(f"no multicast here: {error}")
    motors = plain_trial()["motors"]
    profile = {"kind": "sine", "amplitude": 0.1, "frequency": 5.0, "offset": 0.1}
    motors["left"] = motors["right"] = dict(motors["right"], profile=profile)  # slow, see PATIENT
    robot = CanRobot(bus, silence_ns=round(1e9 * PATIENT), ask=lambda question: "arm")
    path = record(
        Trial.from_plain(plain_trial(0.5, motors=motors)),
        robot,
        tmp_path / "t.mcap",
        transmission=Transmission(),
        gains=Gains(),
        rig="rehearsal",
        limits=Limits(silence=PATIENT),
    )
    robot.close()
    trace = read_log(path)
    assert len(trace) >= 499
    assert trace["left.displacement"].max() > 1e-5
    assert abs(trace["left.current"][-50:].mean() - trace["left.command"][-50:].mean()) < 0.1
