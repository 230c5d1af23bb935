"""What is timed, and how, and how much a second yields.

Timed are trials of smooth moves, as played, logged and decoded, in turns: cycles against bare
MuJoCo, on two threads, and samples of a log.

The bare steps are unmodified `mj_step` on the exported MJCF with its spatial tendons, as many as
the model takes, pulled by the tensions that the model found in the same trial, in C without Python
between the steps.
"""

import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from mujoco import rollout

from spirob.control import CURRENT, VELOCITY, Schedule
from spirob.identify.measurement import Measurement
from spirob.logs import read_log
from spirob.plant import Plant, Response, Rig
from spirob.plant.body import build_spec
from spirob.plant.plant import CYCLE
from spirob.robot import Robot, Scene
from spirob.trials import record
from spirob.trials.simulation import SimulatedRobot
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
            path = record(trial, robot, Path(folder) / f"{trial.name}.mcap", rig)
            found.append(Measurement.from_trace(read_log(path)))
    return found


def measure_cycles(size: Size) -> dict[str, float]:
    """`coupled_tick_over_bare_steps` [-] and `robot_seconds_per_second` [-], one core."""
    plant = Plant(Rig())
    schedule = winding(size.seconds)
    response = plant.simulate(schedule, Scene())
    bare = BareSteps(plant, response)
    farthest = np.abs(bare.run()[-1] - response.angles[-1]).max()
    work = {"coupled": lambda: plant.simulate(schedule, Scene()), "bare": bare.run}
    taken = in_turns(work, size.repeats)
    steps = schedule.cycles * plant.substeps
    return {
        "coupled_tick_over_bare_steps": ratio(taken, "coupled", "bare"),
        "robot_seconds_per_second": schedule.cycles * CYCLE / float(np.median(taken["coupled"])),
        "bare_step_microseconds": float(np.median(taken["bare"])) / steps * 1e6,
        "bare_steps_apart_rad": float(farthest),
    }


class BareSteps:
    """The exported arm, pulled by logged tensions."""

    def __init__(self, plant: Plant, response: Response):
        rig = plant.rig
        spec = build_spec(rig.arm, Scene(), rig.lengths(), CYCLE / plant.substeps, tendons=True)
        self._model = mujoco.MjModel.from_xml_string(spec.to_xml())
        self._data = mujoco.MjData(self._model)
        kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
        self._start = np.zeros(mujoco.mj_stateSize(self._model, kind))
        mujoco.mj_getState(self._model, self._data, self._start, kind)
        # row k of the tension acted in the last substep before cycle k
        acting = np.vstack([response.tension[1:], response.tension[-1:]])
        self._pull = np.repeat(acting, plant.substeps, axis=0)

    def run(self) -> np.ndarray:
        """All steps; the hinge angles after each, (steps, N) [rad]."""
        states, _ = rollout.rollout(self._model, self._data, self._start, self._pull)
        return np.asarray(states)[0, :, 1 : 1 + self._model.nq]


TRIALS = 8


def measure_threads(size: Size) -> dict[str, float]:
    """`two_threads_over_one` [-]: throughput of two threads over that of one."""
    plant = Plant(Rig())
    schedule = winding(size.seconds)

    def play(_: int) -> None:
        plant.simulate(schedule, Scene())

    with ThreadPoolExecutor(1) as one, ThreadPoolExecutor(2) as two:
        work = {
            "one": lambda: list(one.map(play, range(TRIALS))),
            "two": lambda: list(two.map(play, range(TRIALS))),
        }
        taken = in_turns(work, size.repeats)
    return {"two_threads_over_one": ratio(taken, "one", "two")}


def measure_decoding(size: Size) -> dict[str, float]:
    """`decode_samples_per_second` [1/s] of a log recorded for the purpose."""
    rig = Rig()
    trial = moving("decoding", "left", 5.0 * size.seconds)
    with tempfile.TemporaryDirectory() as folder:
        path = record(trial, SimulatedRobot(Plant(rig)), Path(folder) / "trial.mcap", rig)
        taken = in_turns({"decode": lambda: read_log(path)}, size.repeats)
        samples = len(read_log(path))
    return {"decode_samples_per_second": samples / float(np.median(taken["decode"]))}
