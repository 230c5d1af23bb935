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
from spirob.campaign.simulators.bench import SPRINGS
from spirob.campaign.simulators.hidden import drive, level, memory, passive, remember
from spirob.campaign.simulators.motion import FINE
from spirob.diagnosis.model import Model
from spirob.errors import SpirobError
from spirob.identify.scaling import Scaling
from spirob.machine.axis import base_model
from spirob.machine.composed.track import along
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.models import RigSearch

PASSES = 2  # the load follows from the numbers, which move once the law is there
PARTS = (0.3, 0.6, 1.0, 1.6)  # of the drawn way: no two simulators turn friction round alike
OWN = (0.001, 0.003, 0.01, 0.03)  # of half the stroke, where the way is the simulator's own
SLOW = (0.1, 0.3, 3.0, 10.0, 1.0)  # times the speed of rest
RUBBING = ("level", "excess", "by_load", "by_drive", "drift", "spot", "one_way", "power_level")
NOT_OF_THE_MOMENT = ("soft", "play", "payload", "offset", "gain", "lag", "latency", "eccentric")
WHOLE_TURN = 2 * np.pi


def least(made: Drawn, folder: Path) -> float | None:
    """RMSE of the held-out log that the true law leaves; None where the logs cannot be used."""
    of_the_moment = not any(getattr(made.hidden, name) for name in NOT_OF_THE_MOMENT)
    try:
        if of_the_moment:
            return _with_law(made, folder)
        return float(np.sqrt(based(made, made.bare, folder)[1].heldout_square))
    except SpirobError:
        return None


def based(made: Drawn, logs: list[dict[str, np.ndarray]], folder: Path) -> tuple[RigSearch, Model]:
    """The search on logs of a case, whose delay is told, and its model without effects."""
    known = {**made.rig.get("known", {}), "delay": made.about["delay"]}
    rig = RigFile.model_validate({**made.rig, "known": known})
    read = [prepare(f"log_{k}", columns, rig) for k, columns in enumerate(logs)]
    return base_model(rig, folder, read[:-1], read[-1:])


Turn = tuple[str, float]  # how friction turns round: kind, and way or speed of it


def _with_law(made: Drawn, folder: Path) -> float:
    """With friction that turns round as fits the training logs best."""
    search, model = based(made, [*made.train, made.test], folder)
    train, heldout = search.models.train, search.models.heldout
    fits = [_fitted(made, train, model, turn) for turn in _turns(made, train)]
    _, turn, changes, factor = min(fits, key=lambda one: one[0])
    after = heldout(changes) + factor * _shown(made, heldout, changes, turn)
    return float(np.sqrt(np.mean(after**2)))


def _turns(made: Drawn, train: InverseProblem) -> list[Turn]:
    given, half = made.hidden.way, 0.5 * train.sizes.stroke
    if not any(getattr(made.hidden, name) for name in RUBBING):
        return [("speed", train.rest_speed)]
    if given:
        return [("row", given), *(("way", given * part) for part in PARTS)]
    ways: list[Turn] = [("way", half * part) for part in OWN]
    return ways + [("speed", part * train.rest_speed) for part in SLOW]


def _fitted(
    made: Drawn, train: InverseProblem, model: Model, turn: Turn
) -> tuple[float, Turn, dict[str, float], float]:
    """Cost, how friction turns round, numbers of the rig and factor of the law."""
    scaling = Scaling(train.table, list(model.fit.estimates))
    changes, factor, cost = dict(model.fit.changes), 1.0, np.inf
    for _ in range(PASSES):
        shown = _shown(made, train, changes, turn)

        def missed(u: np.ndarray, shown: np.ndarray = shown) -> np.ndarray:
            return train(scaling.physical(u[:-1])) + u[-1] * shown

        start = np.append(np.clip(scaling.scaled(changes), scaling.low, scaling.high), factor)
        ends = np.append(scaling.low, -np.inf), np.append(scaling.high, np.inf)
        found = least_squares(missed, start, bounds=ends, x_scale="jac")
        changes, factor = scaling.physical(found.x[:-1]), float(found.x[-1])
        cost = float(found.cost)
    return cost, turn, changes, factor


def _shown(
    made: Drawn, problem: InverseProblem, changes: dict[str, float], turn: Turn
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
        rub = _turned(v, period, turn)
        signals = np.array([q, v, t, load[rows], constant * motion.effort[rows], rub])
        _law(torque[rows], signals, period, memory(), made.hidden)
    return problem.shown(-scale * torque, changes)


def _turned(v: np.ndarray, period: float, turn: Turn) -> np.ndarray:
    """Dry friction over its level, (n,)."""
    kind, size = turn
    if kind == "speed":
        return np.asarray(np.tanh(v / size))
    if kind == "way":
        return along("bristle", v, [size], np.array([0, len(v)]), np.array([period]))[0]
    return _row(v, period, size, SPRINGS)


@njit(cache=True)
def _row(v, period, way, springs):
    """Of springs that slip one after the other."""
    bends, out = np.zeros(len(springs)), np.empty(len(v))
    for k in range(len(v)):
        for i in range(len(springs)):
            bends[i] = min(max(bends[i] + period * v[k] / (way * springs[i]), -1.0), 1.0)
        out[k] = bends.mean()
    return out


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
