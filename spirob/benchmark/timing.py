"""What is timed, and how: trials of smooth moves, as played, logged and decoded, in turns."""

import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spirob.control.law import CURRENT, VELOCITY, Schedule
from spirob.emulator import EmulatedRobot
from spirob.identify.measurement import Measurement
from spirob.logs import Transmission, read_log
from spirob.plant import Rig
from spirob.robot import Robot, Scene
from spirob.trials import record
from spirob.trials.trial import Trial


@dataclass(frozen=True)
class Size:
    """How much to measure: trial length [s], repeats of quick and of slow things."""

    seconds: float = 2.0
    repeats: int = 21
    slow_repeats: int = 3


TINY = Size(seconds=0.4, repeats=1, slow_repeats=1)


def in_turns(work: Mapping[str, Callable[[], object]], repeats: int) -> dict[str, np.ndarray]:
    """Seconds of each piece of work in each round, after one round that does not count."""
    for run in work.values():
        run()
    taken: dict[str, list[float]] = {name: [] for name in work}
    for _ in range(repeats):
        for name, run in work.items():
            start = time.perf_counter()
            run()
            taken[name].append(time.perf_counter() - start)
    return {name: np.array(times) for name, times in taken.items()}


def ratio(taken: Mapping[str, np.ndarray], over: str, under: str) -> float:
    """Median over rounds of the ratio of two pieces of work timed side by side."""
    return float(np.median(taken[over] / taken[under]))


WIND_IN = 0.05  # m/s
HOLD = 0.2  # A


def winding(seconds: float) -> Schedule:
    """The left tendon wound in at 50 mm/s, the right motor at 0.2 A."""
    reference = np.tile([WIND_IN, HOLD], (round(seconds * 1000), 1))
    mode = np.array([VELOCITY, CURRENT])
    return Schedule(mode, reference, np.zeros_like(reference), np.full(2, 5.0))


def moving(name: str, pulling: str, seconds: float, depth: float = 1.0) -> Trial:
    """Out, back and out again, slow enough that the other tendon stays taut.

    depth  how far, and so how fast, relative to 7 mm/s
    """
    stroke = 0.007 * depth * seconds  # the same speeds however short the trial
    shares = ((0.4, 1.0), (0.1, 1.0), (0.35, 0.3), (0.15, 0.6))
    waypoints = [[time * seconds, share * stroke] for time, share in shares]
    moves = {
        "mode": "displacement",
        "current_limit": 5.0,
        "profile": {"kind": "moves", "waypoints": waypoints},
    }
    hold = {
        "mode": "current",
        "current_limit": 5.0,
        "profile": {"kind": "constant", "value": HOLD, "blend": 0.1 * seconds},
    }
    held = {"left": "right", "right": "left"}[pulling]
    motors = {pulling: moves, held: hold}
    return Trial.from_plain({"name": name, "role": "train", "duration": seconds, "motors": motors})


def recorded(robot: Robot, trials: Sequence[Trial], rig: Rig) -> list[Measurement]:
    """One measurement for each trial; the rig tells gains and transmission."""
    found = []
    with tempfile.TemporaryDirectory(prefix="spirob-recorded-") as folder:
        for trial in trials:
            path = record(
                trial,
                robot,
                Path(folder) / f"{trial.name}.mcap",
                transmission=Transmission(
                    gear_ratio=rig.winch.gear_ratio, winch_radius=rig.winch.radius
                ),
                gains=rig.gains,
                rig=rig.name,
                prepare=lambda scene, name=trial.name: _prepare(robot, scene, name),  # type: ignore[misc]
            )
            found.append(Measurement.from_trace(read_log(path)))
    return found


def _prepare(robot: Robot, scene: Scene, name: str) -> None:
    # an emulated robot's noise belongs to the trial's name
    if isinstance(robot, EmulatedRobot):
        robot.prepare(scene, name)
    else:
        robot.prepare(scene)
