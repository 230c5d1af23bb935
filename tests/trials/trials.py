"""Trials for tests, as a configuration file would have them."""

from typing import Any

from spirob.plant import Rig
from spirob.trials import Trial, record


def plain_trial(duration: float = 0.4, **changes: Any) -> dict[str, Any]:
    left = {
        "mode": "velocity",
        "profile": {"kind": "shuttle", "speeds": [0.05, 0.1], "stroke": 0.01, "dwell": 0.05},
        "current_limit": 5.0,
    }
    right = {
        "mode": "current",
        "profile": {"kind": "sine", "amplitude": 0.5, "frequency": 5.0, "offset": 0.5},
        "current_limit": 2.0,
    }
    trial = {
        "name": "there_and_back",
        "role": "train",
        "duration": duration,
        "motors": {"left": left, "right": right},
        "scene": {"cylinder": {"diameter": 0.04, "x": 0.29, "y": 0.03}},
    }
    return trial | changes


def record_on(robot, folder, duration=0.4, name="trial.mcap", **changes):
    """Record a trial on a robot; the log's path."""
    trial = Trial.from_plain(plain_trial(duration, **changes))
    return record(
        trial,
        robot,
        folder / name,
        Rig(name="fake"),
        config=b"rig: fake\n",
        about={"git_commit": "0" * 40, "start_time": "simulated"},
    )
