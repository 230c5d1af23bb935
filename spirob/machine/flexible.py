"""A flexible model of what is left: how much could still be explained, and from what.

Boosted trees predict the residual on folds left out from the signals of the motion alone.  What
they find is no law, but a ceiling: where they find nothing, no effect of these signals is missing;
and the signals that they need describe an effect that the library does not hold.

Beside them stands a linear regression within bounds, each fold predicted from the others.  All of
it follows from the products of the columns with one another and with the residual, summed over each
fold: the samples are gone through once.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from spirob.diagnosis.flexible import NOTHING, left_out, named, share, tree, worth
from spirob.diagnosis.orders import spectrum
from spirob.machine.inverse import InverseProblem

TALL = 0.3  # of the structured part: a wave that holds so much of it is worth a sentence
SIGNALS = {
    "position": ("position",),
    "speed": ("speed", "direction"),
    "acceleration": ("acceleration",),
    "time": ("time",),
}


@dataclass(frozen=True)
class RigCeiling:
    """What a flexible residual explains on folds left out.

    left       (N,) residual that it leaves on the training trials
    heldout    (M,) the same on the held-out ones
    share      of the squared residual that it explains, 0 where it explains nothing
    order      periods in a turn (or unit angle) of the strongest wave;  wave  its share
    by_signal  what tells the share that a group of signals explains by itself
    """

    left: np.ndarray
    heldout: np.ndarray
    share: float
    order: float
    wave: float
    by_signal: Callable[[], dict[str, float]]

    @cached_property
    def alone(self) -> dict[str, float]:
        """Signal -> share that it explains by itself; four times the work of all else here."""
        return self.by_signal()


def rig_ceiling(
    train: InverseProblem,
    heldout: InverseProblem,
    residual: np.ndarray,
    other: np.ndarray,
    folds: np.ndarray,
) -> RigCeiling:
    """Fit the flexible residual; `residual` and `other` are of the training and held-out trials."""
    features, held = _features(train), _features(heldout)
    names = list(features)

    def without(own: Sequence[str]) -> np.ndarray:
        return left_out(np.column_stack([features[n] for n in own]), residual, folds)

    def by_signal() -> dict[str, float]:
        groups = {group: own for group, own in SIGNALS.items() if set(own) <= set(names)}
        return {group: share(residual, without(own)) for group, own in groups.items()}

    whole = without(names)
    trees = tree().fit(np.column_stack([features[n] for n in names]), residual)
    # as much of it as it was worth on the folds left out: trees know nothing of a time to come
    guess = trees.predict(np.column_stack([held[n] for n in names]))
    rest = other - worth(residual, residual - whole) * guess
    orders, power = spectrum(residual, train.signals()["angle"], 0.01, 100.0)
    top = int(np.argmax(power)) if len(power) else 0
    order, wave = (float(orders[top]), float(power[top])) if len(power) else (0.0, 0.0)
    return RigCeiling(whole, rest, share(residual, whole), order, wave, by_signal)


def depends_on(found: RigCeiling) -> str:
    """What the residual depends on, as the middle of a sentence."""
    best = max(found.alone.values())
    said = f"on {named(found.alone)}" if best > NOTHING else "on several signals together"
    if found.wave > TALL * max(found.share, 0.1):
        said += f", with a wave of {found.order:.3g} periods a turn of the motor"
    return said


def _features(problem: InverseProblem) -> dict[str, np.ndarray]:
    signals = problem.signals()
    signals["direction"] = np.tanh(signals["speed"] / problem.rest_speed)
    told = ("position", "speed", "direction", "acceleration", "time")
    return {n: signals[n] for n in told if n != "position" or problem.rig.position is not None}


RIDGE = 1e-8  # of the mean square of a column
PIVOTS = 20  # of a search for the bounds that hold, all of them at once
ROUNDS = 100  # and one bound each


def products(columns: np.ndarray, residual: np.ndarray, folds: np.ndarray) -> np.ndarray:
    """Sums over each fold of the products of n columns (N, n) and, last, the residual (N,).

    folds  (N,) label of each sample; a fold is a run of equal labels;  result (K, n + 1, n + 1)
    """
    stacked = np.column_stack([columns, residual])
    return np.array([part.T @ part for part in np.split(stacked, _edges(folds))])


def steps(sums: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """For each fold the coefficients, within bounds, that the other folds choose, (K, n)."""
    others = sums.sum(axis=0) - sums
    return bounded(others[:, :-1, :-1], others[:, :-1, -1], low, high)


def step(sums: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """argmin |r + A·x|² within bounds over all folds, (n,)."""
    whole = sums.sum(axis=0)[None]
    return np.asarray(bounded(whole[:, :-1, :-1], whole[:, :-1, -1], low, high)[0])


def error(sums: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
    """Squared residual, summed, of the folds left out after a step that the others chose."""
    moved = steps(sums, low, high)
    after = np.column_stack([moved, np.ones(len(moved))])  # the residual itself counts once
    return max(0.0, float(np.einsum("ki,kij,kj->", after, sums, after)))


def left_out_linear(
    columns: np.ndarray,
    residual: np.ndarray,
    folds: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
) -> np.ndarray:
    """The residual of each fold after a step, within bounds, that the other folds chose, (N,)."""
    moved = steps(products(columns, residual, folds), low, high)
    parts = zip(np.split(columns, _edges(folds)), moved, strict=True)
    return residual + np.concatenate([part @ x for part, x in parts])


def _edges(folds: np.ndarray) -> np.ndarray:
    return np.flatnonzero(np.diff(folds)) + 1


def bounded(gram: np.ndarray, side: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """argmin |r + A·x|² within bounds for K residuals, (K, n).

    gram  Aᵀ·A, (K, n, n), or (1, n, n) where it is the same for all;  side  Aᵀ·r, (K, n)
    """
    size = np.sqrt(np.diagonal(gram, axis1=1, axis2=2))
    size = np.where(size > 0.0, size, 1.0)  # a column of zeros gets a coefficient of zero
    scaled = gram / (size[:, :, None] * size[:, None, :]) + RIDGE * np.eye(gram.shape[1])
    goal = -side / size
    scaled, size = (np.broadcast_to(part, (len(goal), *part.shape[1:])) for part in (scaled, size))
    found = np.linalg.solve(scaled, goal[:, :, None])[:, :, 0] / size
    out = np.any((found < low) | (found > high), axis=1)
    if np.any(out):
        edges = low * size[out], high * size[out]
        found[out] = _within(scaled[out], goal[out], *edges) / size[out]
    return np.asarray(found)


def _within(gram: np.ndarray, goal: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """argmin x·G·x/2 - g·x within bounds for K problems, (K, n): block principal pivoting.

    Whatever leaves its bounds is held there, whatever a bound holds against the slope is let go,
    all at once; where that goes round in circles, one at a time (Júdice and Pires 1994).
    """
    found, side, going = np.empty_like(goal), np.zeros(goal.shape, int), np.arange(len(goal))
    for _ in range(PIVOTS):
        own, sides, least, most = gram[going], side[going], low[going], high[going]
        free = sides == 0
        held = np.where(sides < 0, least, np.where(sides > 0, most, 0.0))
        pushed = goal[going] - (own @ held[:, :, None])[:, :, 0]
        alone = np.where(free[:, :, None] & free[:, None, :], own, np.eye(goal.shape[1]))
        moved = np.linalg.solve(alone, np.where(free, pushed, held)[:, :, None])[:, :, 0]
        slope = (own @ moved[:, :, None])[:, :, 0] - goal[going]
        out = (moved > most).astype(int) - (moved < least)
        following = np.where(free, out, np.where(slope * sides > 0.0, 0, sides))
        found[going], side[going] = moved, following
        going = going[np.any(following != sides, axis=1)]
        if not len(going):
            break
    for k in going:
        found[k] = _one_by_one(gram[k], goal[k], low[k], high[k])
    return found


def _one_by_one(
    gram: np.ndarray, goal: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    root = _root(gram)
    target = np.linalg.solve(root, goal)
    found = scipy.optimize.lsq_linear(root.T, target, (low, high), method="bvls", max_iter=ROUNDS)
    return np.asarray(found.x)


def _root(gram: np.ndarray) -> np.ndarray:
    """R with R·Rᵀ = gram, whose least eigenvalue rounding may have taken below the ridge."""
    sizes, axes = np.linalg.eigh(gram)
    return np.asarray(axes * np.sqrt(np.maximum(sizes, RIDGE)))
