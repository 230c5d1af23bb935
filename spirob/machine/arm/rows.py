"""Which cycles of an arm's log are compared: those that its numbers determine.

All of a log is played, as what the arm did before is in its state.  A row that is left out counts
in no signal of its trial: both motors pull at one arm, and a current that one of them lacks is
missing in what the other has to hold.

An arm of point hinges between two taut tendons buckles: hinges snap from one side to the other, and
which of them does so when, the scatter from hinge to hinge decides, of which nobody knows.  So each
trial is played with the hinges of some builds, stiffness and damping drawn hinge by hinge, and a
cycle counts only where these plays are apart by no more than a model is said to be complete within.
Nothing of what was measured takes part, so a held-out log stays held out.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from spirob.errors import SimulationError
from spirob.identify.builds import hinges
from spirob.identify.measurement import Measurement
from spirob.identify.residual import STILL, Residual
from spirob.machine import checks
from spirob.machine.arm.description import ArmFile
from spirob.machine.checks import FULL, widened
from spirob.machine.motion import LEAST, holds
from spirob.robot import MOTORS

CYCLE = 1e-3  # s, of the model
STANDS = "where the working motor stands"


def usable(
    name: str,
    current: np.ndarray,
    velocity: np.ndarray,
    moves: int,
    rig: ArmFile,
    said: list[str],
) -> np.ndarray | None:
    """Cycles that are compared, (T,); None where none is left out.

    current   unfiltered [A], (T, 2);  velocity  filtered [m/s], (T, 2)
    moves     the motor that does the work, whose speed counts
    said      gets a sentence for each reason

    Raises DataError where less than a second is left.
    """
    use, lost = np.ones(len(current), bool), []
    if rig.filter.drop:
        use[: rig.filter.drop] = use[-rig.filter.drop :] = False
    for out, why in _left_out(current, velocity[:, moves], MOTORS[moves], rig):
        if why == STANDS and np.count_nonzero(use & ~out) < LEAST * np.count_nonzero(use):
            said.append(f"{name}: the working motor stands most of the time.")
        elif out.any():
            use &= ~out
            lost.append(f"{out.mean():.1%} of the rows left out, {why}")
    checks.enough(name, CYCLE * np.count_nonzero(use), "; ".join(lost))
    said += [f"{name}: {text}." for text in lost]
    return None if use.all() else use


def _left_out(
    current: np.ndarray, v: np.ndarray, working: str, rig: ArmFile
) -> Iterator[tuple[np.ndarray, str]]:
    """Cycles that do not count, (T,), and why; v is the speed of the working motor [m/s]."""
    reach = round(0.5 / (rig.filter.cutoff * CYCLE))  # the filter smears what is beside a row
    for m, (motor, columns) in enumerate(rig.motors().items()):
        if columns.effort.limit is not None:
            limit = columns.effort.limit * columns.amperes(columns.effort)
            full = np.abs(current[:, m]) >= FULL * limit
            yield widened(full, reach), f"where the drive of the {motor} motor saturates"
    speed = np.abs(v) / rig.motors()[working].metres(rig.machine())
    if rig.rows.minimum_speed is not None:
        yield speed < rig.rows.minimum_speed, "as too slow"
    elif rig.rows.standstill == "drop":
        yield holds(v, STILL, CYCLE), STANDS
    if rig.rows.maximum_speed is not None:
        yield speed > rig.rows.maximum_speed, "as too fast"


BUILDS = 8
TOLD = 0.1  # s; a trial with less of it says nothing, and is left out whole
LEAST_TIME = (
    1.0  # s of all logs of a role that count in any case, those that builds leave least open
)


def determined(
    residual: Residual, changes: Mapping[str, float], limit: float
) -> tuple[list[Measurement], float]:
    """The trials without what builds leave open, and the share of their cycles that counts.

    changes  the numbers at which they are played
    limit    by how much builds may be apart, RMS [A]
    """
    apart = [spread(residual, changes, k) for k in range(len(residual.trials))]
    used = [
        np.ones(len(a), bool) if t.use is None else t.use
        for a, t in zip(apart, residual.trials, strict=True)
    ]
    every = np.sort(np.concatenate([a[use] for a, use in zip(apart, used, strict=True)]))
    limit = max(limit, float(every[min(len(every), round(1e3 * LEAST_TIME)) - 1]))
    kept = [use & (a <= limit) for a, use in zip(apart, used, strict=True)]
    counts = [int(np.count_nonzero(use)) for use in kept]
    trials = [
        replace(trial, use=use)
        for trial, use, count in zip(residual.trials, kept, counts, strict=True)
        if count >= min(max(counts), round(1e3 * TOLD))
    ]
    return trials, float(sum(counts) / len(every))


def spread(residual: Residual, changes: Mapping[str, float], index: int) -> np.ndarray:
    """RMS by which builds differ in a trial, cycle by cycle, (T,) [A].

    The larger of the working motor's current and of the other one's length, at the residual's
    weight; infinite from where a build cannot be played on.
    """
    whole = replace(residual, trials=[replace(residual.trials[index], use=None)])
    whole = replace(whole, filter=replace(residual.filter, every=1))
    cycles, units = len(whole.trials[0].current), residual.plant.rig.units
    rng, total = np.random.default_rng(0), np.zeros(cycles)
    middle = _signals(whole, changes)
    for _ in range(BUILDS):
        build = replace(whole, plant=residual.plant.scattered(hinges(rng, units)))
        try:
            total += np.max((_signals(build, changes) - middle) ** 2, axis=0)
        except SimulationError:
            return np.full(cycles, np.inf)
    return np.sqrt(total / BUILDS)


def _signals(residual: Residual, changes: Mapping[str, float]) -> np.ndarray:
    """Model minus measurement of one trial, a row for each signal that counts, (signals, T) [A]."""
    trial = residual.trials[0]
    signals = residual.one(changes, 0).reshape(-1, len(trial.current))
    return signals[: 2 * len(residual.driven(trial))]
