"""The error that knowing the hidden law leaves: the law itself, run over the measured motion.

The law of the simulators (`laws`), with the numbers that were drawn, over the signals of the logs,
as any model would have to; one factor is fitted beside the rig's numbers.  What acts on no torque
of the moment (an elastic shaft, play, an error of a reading) cannot be run so: then it is the error
of the fitted numbers on the same machine with nothing hidden.
"""

from pathlib import Path

import numpy as np
from numba import njit
from scipy.optimize import least_squares

from spirob.campaign.case import Drawn
from spirob.campaign.recorder import AHEAD
from spirob.campaign.simulators.laws import drive, level, memory, passive, remember
from spirob.campaign.simulators.motion import FINE
from spirob.errors import SpirobError
from spirob.identify.scaling import Scaling
from spirob.machine.axis import base_model
from spirob.machine.composed.memory import along
from spirob.machine.inverse import InverseProblem
from spirob.machine.models import Model
from spirob.machine.recording import prepare
from spirob.machine.rig import RigFile

PASSES = 2  # the load follows from the numbers, which move once the law is there
PARTS = (0.3, 0.6, 1.0, 1.6)  # of the drawn way: no two simulators turn friction round alike
OWN = (0.001, 0.003, 0.01, 0.03)  # of half the stroke, where the way is the simulator's own
RUBBING = ("level", "excess", "by_load", "by_drive", "drift", "spot", "one_way", "power_level")
NOT_OF_THE_MOMENT = ("soft", "play", "payload", "offset", "gain", "lag", "latency", "eccentric")
WHOLE_TURN = 2 * np.pi


def least(made: Drawn, folder: Path) -> float | None:
    """RMSE of the held-out log that the true law leaves; None where the logs cannot be used."""
    of_the_moment = not any(getattr(made.hidden, name) for name in NOT_OF_THE_MOMENT)
    try:
        if of_the_moment:
            return _with_law(made, folder)
        return float(np.sqrt(_base(made, made.bare, folder)[2].heldout_square))
    except SpirobError:
        return None


def _base(
    made: Drawn, logs: list[dict[str, np.ndarray]], folder: Path
) -> tuple[InverseProblem, InverseProblem, Model]:
    rig = RigFile.model_validate(made.rig)
    read = [prepare(f"log_{k}", columns, rig) for k, columns in enumerate(logs)]
    search, model = base_model(rig, folder, read[:-1], read[-1:])
    return search.train, search.heldout, model


def _with_law(made: Drawn, folder: Path) -> float:
    """Of the ways over which its friction may turn round, the one that fits the training logs."""
    train, heldout, model = _base(made, [*made.train, made.test], folder)
    half = 0.5 * train.sizes.stroke
    given = made.hidden.way
    ways = [given * part for part in PARTS] if given else [0.0, *(half * part for part in OWN)]
    rubs = any(getattr(made.hidden, name) for name in RUBBING)
    fits = [_fitted(made, train, model, way) for way in (ways if rubs else [0.0])]
    _, way, changes, factor = min(fits, key=lambda one: one[0])
    after = heldout(changes) + factor * _shown(made, heldout, changes, way)
    return float(np.sqrt(np.mean(after**2)))


def _fitted(
    made: Drawn, train: InverseProblem, model: Model, way: float
) -> tuple[float, float, dict[str, float], float]:
    """Cost, way, numbers of the rig and factor of the law."""
    scaling = Scaling(train.table, list(model.fit.estimates))
    changes, factor, cost = dict(model.fit.changes), 1.0, np.inf
    for _ in range(PASSES):
        shown = _shown(made, train, changes, way)

        def missed(u: np.ndarray, shown: np.ndarray = shown) -> np.ndarray:
            return train(scaling.physical(u[:-1])) + u[-1] * shown

        start = np.append(np.clip(scaling.scaled(changes), scaling.low, scaling.high), factor)
        ends = np.append(scaling.low, -np.inf), np.append(scaling.high, np.inf)
        found = least_squares(missed, start, bounds=ends, x_scale="jac")
        changes, factor = scaling.physical(found.x[:-1]), float(found.x[-1])
        cost = float(found.cost)
    return cost, way, changes, factor


def _shown(
    made: Drawn, problem: InverseProblem, changes: dict[str, float], way: float
) -> np.ndarray:
    """What the hidden law makes of the residual, (N,)."""
    vector = problem.table.vector(problem.completed(changes))
    motion = problem.asked.seen(vector)
    constant, own = made.machine.constant, problem.asked.own(vector)
    scale = own["scale"] / constant  # of the model's torque over the machine's
    load = problem.asked.load(motion, vector) / scale
    begun = AHEAD + 1.0 / made.about["rate"]
    torque = np.empty(len(motion.q))
    for k, name in enumerate(motion.logs):
        rows = slice(motion.starts[k], motion.starts[k + 1])
        t, v = motion.seconds[rows] + begun, motion.v[rows]
        q = motion.q[rows] + _shift(made, name, t[0], motion.q[rows][0])
        period = float(motion.steps[k])
        share = np.tanh(v / problem.rest_speed)
        if way > 0.0:
            share = along("bristle", v, way, np.array([0, len(v)]), np.array([period]))
        signals = np.array([q, v, t, load[rows], constant * motion.effort[rows], share])
        _law(torque[rows], signals, period, memory(), made.hidden)
    return problem.shown(-scale * torque, changes)


def _shift(made: Drawn, name: str, t: float, q: float) -> float:
    """Whole turns between a log's position and the machine's."""
    if not made.machine.angular:
        return 0.0
    true = made.played[int(name.removeprefix("log_"))].q[round(t * FINE)]
    return float(WHOLE_TURN * np.rint((true - q) / WHOLE_TURN))


@njit(cache=True)
def _law(out, signals, period, cells, h):
    """Effort that is hidden, as torque, along the measured motion of one piece."""
    for k in range(len(out)):
        q, v, t, load, motor, share = signals[:, k]
        rub = level(q, v, t, load, motor, h) * share
        out[k] = rub - passive(q, v, cells, h) + motor - drive(motor, q, v, cells, h)
        remember(cells, motor, v, period, h)
