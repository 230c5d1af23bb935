"""How much a second yields: cycles against bare MuJoCo, on two threads, samples of a log.

The bare steps are unmodified `mj_step` on the exported MJCF with its spatial tendons, as many as
the model takes, pulled by the tensions that the model found in the same trial, in C without Python
between the steps.
"""

import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mujoco
import numpy as np
from mujoco import rollout

from spirob.benchmark.timing import Size, in_turns, moving, ratio, winding
from spirob.logs import Transmission, read_log
from spirob.plant import Plant, Response, Rig
from spirob.plant.body import build_spec
from spirob.plant.plant import CYCLE
from spirob.robot import Scene
from spirob.trials import record
from spirob.trials.simulation import SimulatedRobot


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
        path = record(
            trial,
            SimulatedRobot(Plant(rig)),
            Path(folder) / "trial.mcap",
            transmission=Transmission(),
            gains=rig.gains,
            rig=rig.name,
        )
        taken = in_turns({"decode": lambda: read_log(path)}, size.repeats)
        samples = len(read_log(path))
    return {"decode_samples_per_second": samples / float(np.median(taken["decode"]))}
