"""The rehearsal for a laboratory: the emulator as a process of its own on a network bus."""

import signal
import subprocess
import sys
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import can
import pytest

from spirob.can.bus import open_bus
from spirob.can.limits import Limits
from spirob.can.robot import CanRobot
from spirob.errors import HardwareError
from spirob.logs import read_log
from spirob.plant import Rig
from spirob.trials import Trial, record
from tests.can.stalls import HELD_UP, Worst, pauses_of, steady
from tests.trials.trials import plain_trial

CHANNEL = "239.74.163.77"
NETWORK = ["--interface", "udp_multicast", "--channel", CHANNEL]
PATIENT = 0.9  # s: the machine that tests may stop a process for a while


@contextmanager
def process(*asked):
    """A process of its own, killed at the end; what it says is read from its `stdout`."""
    started = subprocess.Popen(
        [sys.executable, *asked],
        cwd=Path(__file__).parents[2],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # a shell's job in the background ignores Ctrl-C, and would hand that down
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )
    try:
        yield started
    finally:
        started.kill()
        started.communicate()


@contextmanager
def emulator():
    """The emulated robot, straight and at rest, once it serves."""
    with process("-m", "spirob.emulator", *NETWORK, "--seconds", "120") as started:
        if "serving" not in started.stdout.readline():
            pytest.skip(f"no multicast here: {started.communicate()[1].strip()}")
        yield started


def play(folder, duration, left, right):
    """Record a trial with these plans of the motors over the network bus."""
    try:
        bus = pauses_of(open_bus("udp_multicast", CHANNEL))
    except (HardwareError, can.CanError) as error:
        pytest.skip(f"no multicast here: {error}")
    robot = CanRobot(bus, silence_ns=round(1e9 * PATIENT), ask=lambda question: "arm")
    try:
        return record(
            Trial.from_plain(plain_trial(duration, motors={"left": left, "right": right})),
            robot,
            folder / "t.mcap",
            Rig(),
            limits=Limits(silence=PATIENT),
        )
    finally:
        robot.close()


@steady
def test_a_trial_is_recorded_from_another_process(tmp_path):
    slow = {"kind": "sine", "amplitude": 0.1, "frequency": 5.0, "offset": 0.1}  # see PATIENT
    both = {"mode": "current", "profile": slow, "current_limit": 2.0}
    with emulator():
        path = play(tmp_path, 0.5, both, both)
    trace = read_log(path)
    assert len(trace) >= 499
    assert trace["left.displacement"].max() > 1e-5
    assert abs(trace["left.current"][-50:].mean() - trace["left.command"][-50:].mean()) < 0.1


@steady
def test_a_third_process_watches_the_arm_run_into_itself(tmp_path):
    wind = {"kind": "constant", "value": 0.12, "blend": 0.1}
    left = {"mode": "velocity", "profile": wind, "current_limit": 5.0}
    right = {"mode": "current", "profile": {"kind": "constant", "value": 0.0}, "current_limit": 1.0}
    watching = ["-m", "spirob.cli.main", "watch", *NETWORK, "--model", "none", "--seconds", "110"]
    with emulator(), process(*watching) as watch:
        first = watch.stdout.readline()
        assert first == f"both motors are heard on udp_multicast:{CHANNEL}\n", watch.stderr.read()
        play(tmp_path, 2.2, left, right)
        watch.send_signal(signal.SIGINT)
        told = watch.communicate(timeout=60)[0]
    if "gap:" in told:  # the watch was held up, or the emulator
        Worst.note(2 * HELD_UP)
    contacts = [line for line in told.splitlines() if "contact:" in line]
    assert len(contacts) == 1, told
    assert "left   contact: +" in contacts[0]
    assert watch.returncode == 130


def test_scan_and_check_see_the_emulator_on_the_network():
    with emulator():
        scan = [sys.executable, "-m", "spirob.cli.main", "can", "scan", *NETWORK]
        said = subprocess.run(scan, capture_output=True, text=True, check=True).stdout
    assert "0x201" in said
    assert "c620 feedback, right" in said
