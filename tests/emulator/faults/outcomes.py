"""What a fault does to a trial: `python -m tests.emulator.faults.outcomes` prints the table."""

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spirob.can.limits import Limits
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.errors import HardwareError
from spirob.logs import read_log
from spirob.logs.messages import unpack_frames
from spirob.logs.reader import read_content
from spirob.logs.trace import Trace
from spirob.plant import Rig
from spirob.trials import Trial, record

START = 0.4  # s
LIMITS = Limits(current=5.0, slew=500.0, travel=0.25, speed=0.2, temperature=80.0)
FAULTS = {
    "none": [],
    "lost 1 %": [{"kind": "lost", "probability": 0.01}],
    "lost 10 %": [{"kind": "lost", "probability": 0.1}],
    "lost, burst of 8 ms": [{"kind": "lost", "probability": 1.0, "duration": 0.008}],
    "commands lost 10 %": [{"kind": "lost", "frames": "command", "probability": 0.1}],
    "late 3 ms": [{"kind": "late", "delay": 0.003}],
    "duplicated 10 %": [{"kind": "duplicated"}],
    "out of order 10 %": [{"kind": "out_of_order"}],
    "corrupted 1 %": [{"kind": "corrupted"}],
    "corrupted 10 %": [{"kind": "corrupted", "probability": 0.1}],
    "silent motor": [{"kind": "silent_motor", "motor": "left"}],
    "bus off": [{"kind": "bus_off"}],
    "encoder wrap": [{"kind": "encoder_wrap", "start": 0.0}],
    "encoder stuck": [{"kind": "encoder_stuck", "motor": "left"}],
    "encoder jump": [{"kind": "encoder_jump", "motor": "left"}],
    "feedback frozen": [{"kind": "feedback_frozen", "motor": "left"}],
    "power dip 20 ms": [{"kind": "power_dip", "duration": 0.02}],
    "power dip 1 s": [{"kind": "power_dip", "duration": 1.0}],
}


@dataclass
class Outcome:
    """What came of it.

    said     the sentence of the stop, or None where the trial was played to its end
    safe     from the fault to the zero command [s], where there was a stop
    trace    what the log holds;  handed, kept  frames that reached the controller and the log
    """

    said: str | None
    safe: float | None
    trace: Trace
    handed: int
    kept: int


class Counting(EmulatedRobot):
    """Counts the frames that it hands to the controller."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.handed = []

    def exchange(self, command):
        frames = super().exchange(command)
        self.handed += frames
        return frames


def trial(seconds=1.0):
    """Left winds in at 50 mm/s, right holds a small current."""
    left = {
        "mode": "velocity",
        "profile": {"kind": "shuttle", "speeds": [0.05, 0.05], "stroke": 0.03, "dwell": 0.05},
        "current_limit": 5.0,
    }
    right = {
        "mode": "current",
        "profile": {"kind": "constant", "value": 0.2, "blend": 0.1},
        "current_limit": 5.0,
    }
    plain = {"name": "trial", "role": "train", "duration": seconds}
    return Trial.from_plain(plain | {"motors": {"left": left, "right": right}})


def outcome(name, folder, seconds=1.0):
    """Play the trial with a fault."""
    faults = [{"start": START} | fault for fault in FAULTS[name]]
    robot = Counting(EmulatedRig(), HiddenSettings("none"), 1, faults)
    path, said, safe = Path(folder) / "faulty.mcap", None, None
    try:
        record(
            trial(seconds),
            robot,
            path,
            Rig(),
            limits=LIMITS,
        )
    except HardwareError as error:
        said = str(error)
        path = path.with_name(path.name + ".part")
        safe = [f for f in robot.handed if f.arbitration_id == 0x200][-1].stamp_ns * 1e-9 - START
    robot.close()
    raw, _ = unpack_frames(read_content(path).messages["/can/raw"])
    handed = len(robot.handed) - (0 if said else 3)  # the last zero comes after the log
    return Outcome(said, safe, read_log(path), handed, len(raw))


def table():
    """Every fault, one to a line of Markdown."""
    with tempfile.TemporaryDirectory() as folder:
        whole = outcome("none", folder).trace
        print("| fault | what happened | safe after | missing, duplicate | current |")
        print("|---|---|---|---|---|")
        for name in FAULTS:
            found = outcome(name, folder)
            counts = found.trace.meta["frames"]
            rows = len(found.trace)
            error = found.trace["left.current"] - whole["left.current"][:rows]
            rms = np.sqrt(np.mean(error**2)) / np.sqrt(np.mean(whole["left.current"] ** 2))
            said = found.said or "played to the end"
            safe = "" if found.safe is None else f"{1e3 * found.safe:.0f} ms"
            missing = f"{counts['left.missing']}, {counts['left.duplicate']}"
            assert found.handed == found.kept
            print(f"| {name} | {said} | {safe} | {missing} | {100 * rms:.1f} % |")


if __name__ == "__main__":
    table()
