"""What could still be explained by any law: boosted trees on data left out.

Trees learn the residual of the training trials from the motion and from the model's own effort.
The measured effort is no input: its noise is in the residual, and would be found there again.  A
ceiling is reported beside the ladder; no verdict looks at it.

They share nothing with the effects of the library and obey no law; what they find on trials that
they were not fitted to is there to be explained.

What a residual depends on is told alike: from one signal at a time, learned on some folds and
scored on those left out, so a share says what comes again, and of noise it is none.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from threadpoolctl import threadpool_limits

from spirob.diagnosis.spectrum import Order
from spirob.identify.problem import Problem, Stretch

if TYPE_CHECKING:
    from sklearn.ensemble import HistGradientBoostingRegressor

BLOCKS = 5  # folds of one or two trials


def folds_of(edges: np.ndarray) -> np.ndarray:
    """Label of the fold of each sample: its trial, or a block of the whole where trials are few."""
    trials = len(edges) - 1
    if trials >= 3:
        return np.repeat(np.arange(trials), np.diff(edges))
    samples = int(edges[-1])
    return np.arange(samples) * BLOCKS // samples


def one_thread() -> threadpool_limits:
    """For small matrices and trees: threads that wait cost more than they win, and round apart.

    Only what is loaded already is limited, so the library of the trees is loaded first.
    """
    import sklearn.ensemble  # noqa: F401  slow to import

    return threadpool_limits(1)


def tree() -> "HistGradientBoostingRegressor":
    """The trees, not fitted yet; shallow and slow: noise must not look like structure."""
    from sklearn.ensemble import HistGradientBoostingRegressor  # slow to import

    return HistGradientBoostingRegressor(
        max_iter=60, learning_rate=0.1, max_leaf_nodes=12, min_samples_leaf=30, random_state=0
    )


def left_out(features: np.ndarray, residual: np.ndarray, folds: np.ndarray) -> np.ndarray:
    """What trees fitted to the other folds leave of each fold, (N,); features (N, F)."""
    out = np.empty_like(residual)
    for k in np.unique(folds):
        inside = folds == k
        found = tree().fit(features[~inside], residual[~inside])
        out[inside] = residual[inside] - found.predict(features[inside])
    return out


def worth(residual: np.ndarray, predicted: np.ndarray) -> float:
    """The factor, 0 to 1, with which predictions of folds left out come closest."""
    power = float(np.dot(predicted, predicted))
    return float(np.clip(np.dot(residual, predicted) / power, 0.0, 1.0)) if power > 0 else 0.0


def share(before: np.ndarray, after: np.ndarray) -> float:
    """Share of the squared residual that is gone, at least 0."""
    return max(0.0, 1.0 - float(np.sum(after**2) / max(np.sum(before**2), 1e-300)))


@dataclass(frozen=True)
class Ceiling:
    """What a flexible residual on top of a model leaves.

    left   role -> model minus measurement of the effort that is left, (n,) in its unit
    share  of the squared training residual that is explained on folds left out
    """

    left: dict[str, np.ndarray]
    share: float


def ceiling(problems: Mapping[str, Problem], missed: Mapping[str, np.ndarray]) -> Ceiling:
    """Fit the flexible residual; `missed` is model minus measurement by role, (N,) each.

    On training trials, "train", what is left is of trees fitted to the other trials.  All is taken
    away by the factor by which that came closest, so no more is left than was there to be learned.
    """
    inputs = _inputs(problems, missed)
    rest = {role: values[problems[role].rows] for role, values in missed.items()}
    train = problems["train"]
    with one_thread():
        folds = folds_of(train.edges)[train.rows]
        found = rest["train"] - left_out(inputs["train"], rest["train"], folds)
        trees = tree().fit(inputs["train"], rest["train"])
        guess = {r: found if r == "train" else trees.predict(inputs[r]) for r in rest}
    factor = worth(rest["train"], found)
    left = {role: rest[role] - factor * guess[role] for role in rest}
    return Ceiling(left, share(rest["train"], left["train"]))


def _inputs(
    problems: Mapping[str, Problem], missed: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """What the trees see, by role: (n, 8)."""
    stretches = {role: problems[role].stretches() for role in missed}
    channels = sorted({s.channel for found in stretches.values() for s in found})
    inputs = {}
    for role, values in missed.items():
        modelled = (problems[role].measured() + values)[problems[role].rows]
        motion = [_motion(s, channels) for s in stretches[role]]
        inputs[role] = np.column_stack([np.concatenate(motion), modelled])
    return inputs


def _motion(piece: Stretch, channels: Sequence[str]) -> np.ndarray:
    """Position, speed, direction, acceleration, time, time since a reversal, motor, (n, 7)."""
    seconds, velocity = piece.seconds, piece.velocity
    turns = np.flatnonzero(np.diff(np.sign(velocity)) != 0) + 1
    begun = seconds[np.concatenate([[0], turns])]
    since = seconds - begun[np.searchsorted(turns, np.arange(len(seconds)), "right")]
    motor = np.full(len(seconds), float(channels.index(piece.channel)))
    direction = np.tanh(velocity / piece.still)
    faster = np.gradient(velocity, seconds)
    return np.column_stack([piece.position, velocity, direction, faster, seconds, since, motor])


TOGETHER = "all but time"  # of one trial only there is nothing in its time that comes again
SINGLE = 0.3  # of what all explain together: what one signal has to do by itself to be named
LITTLE = 0.2  # of the residual: who foretells no more does not describe it
NOTHING = 0.05  # a signal that foretells less of the residual is none that it depends on


def dependence(residual: Problem, values: np.ndarray) -> dict[str, float]:
    """Signal -> share of the squared residual (N,) that it explains by itself on folds left out.

    A fold is a trial where every motor has several, else half-second blocks.
    """
    pieces = residual.stretches()
    features = _features(pieces)
    features[TOGETHER] = [c for n, own in features.items() if n != "time" for c in own]
    folds = _folds(pieces, residual.block)
    with one_thread():
        return {
            name: share(values, left_out(np.column_stack(columns), values, folds))
            for name, columns in features.items()
        }


def told(alone: Mapping[str, float], waves: Sequence[Order] = ()) -> str:
    """A sentence on what a residual depends on.

    alone  as `dependence` returned it;  waves  those that come again in every trial
    """
    singles = {name: value for name, value in alone.items() if name != TOGETHER}
    whole, best = alone[TOGETHER], max(singles.values())
    if NOTHING < max(best, whole) <= LITTLE:
        said = f"Little of the residual comes again in another trial ({max(best, whole):.0%} of it)"
    elif best > max(NOTHING, SINGLE * whole):
        said = f"The residual depends on {named(singles)}"
    elif whole > NOTHING:
        said = f"The residual depends on several signals together ({whole:.0%} of it)"
    else:
        said = (
            f"The residual follows none of {', '.join(singles)} from one trial to another, nor all "
            "of these together"
        )
    for wave in sorted(waves, key=lambda w: -w.share_of_error)[:1]:
        turns = "the motor" if wave.of == "motor" else "the gear's output"
        said += (
            f"; {wave.share_of_error:.0%} is a wave of {wave.order:.3g} periods a turn of {turns}"
        )
    return f"{said}."


def named(alone: Mapping[str, float]) -> str:
    """The signals that explain most, "speed (40% by itself) and load (25% by itself)"."""
    strong = sorted(alone, key=lambda name: -alone[name])
    most = alone[strong[0]]
    return " and ".join(
        f"{name} ({alone[name]:.0%} by itself)" for name in strong if alone[name] > 0.4 * most
    )


def _features(pieces: Sequence[Stretch]) -> dict[str, list[np.ndarray]]:
    """Signal -> columns along the residual, the motor's number last."""

    def joined(of: Sequence[np.ndarray]) -> np.ndarray:
        return np.concatenate(list(of))

    channels = list(dict.fromkeys(p.channel for p in pieces))
    motor = joined([np.full(len(p.seconds), float(channels.index(p.channel))) for p in pieces])
    speed = joined([p.velocity for p in pieces])
    direction = joined([np.tanh(p.velocity / p.still) for p in pieces])
    return {
        "position": [joined([p.position for p in pieces]), motor],
        "speed": [speed, direction, motor],
        "acceleration": [joined([np.gradient(p.velocity, p.seconds) for p in pieces]), motor],
        "load": [joined([p.effort for p in pieces]), motor],
        "time": [joined([p.seconds for p in pieces]), motor],
    }


def _folds(pieces: Sequence[Stretch], block: int) -> np.ndarray:
    """Fold of each sample, (N,)."""
    trials = list(dict.fromkeys(p.trial for p in pieces))
    several = all(len({q.trial for q in pieces if q.channel == p.channel}) > 1 for p in pieces)
    if several:
        return np.concatenate([np.full(len(p.seconds), trials.index(p.trial)) for p in pieces])
    samples = np.arange(sum(len(p.seconds) for p in pieces))
    return samples // block % BLOCKS
