"""A flexible model of what is left: how much could still be explained, and from what.

Boosted trees predict the residual on folds left out from the signals of the motion alone.  What
they find is no law, but a ceiling: where they find nothing, no effect of these signals is missing;
and the signals that they need describe an effect that the library does not hold.
"""

from dataclasses import dataclass

import numpy as np

from spirob.diagnosis.depends import NOTHING, named
from spirob.diagnosis.periodogram import spectrum
from spirob.diagnosis.trees import left_out, share, tree, worth
from spirob.machine.inverse import InverseProblem

TALL = 0.3  # of the structured part: a wave that holds so much of it is worth a sentence
SIGNALS = {
    "position": ("position",),
    "speed": ("speed", "direction"),
    "acceleration": ("acceleration",),
    "time": ("time",),
}


@dataclass(frozen=True)
class Ceiling:
    """What a flexible residual explains on folds left out.

    left       (N,) residual that it leaves on the training trials
    heldout    (M,) the same on the held-out ones
    share      of the squared residual that it explains, 0 where it explains nothing
    alone      signal -> share that this signal explains by itself
    order      periods in a turn (or unit angle) of the strongest wave;  wave  its share
    """

    left: np.ndarray
    heldout: np.ndarray
    share: float
    alone: dict[str, float]
    order: float
    wave: float


def ceiling(
    train: InverseProblem,
    heldout: InverseProblem,
    residual: np.ndarray,
    other: np.ndarray,
    folds: np.ndarray,
    split: bool = True,
) -> Ceiling:
    """Fit the flexible residual; `residual` and `other` are of the training and held-out trials.

    split  also say what each signal explains by itself
    """
    features, held = _features(train), _features(heldout)
    names = list(features)
    whole = left_out(np.column_stack([features[n] for n in names]), residual, folds)
    alone = {
        group: share(
            residual, left_out(np.column_stack([features[n] for n in own]), residual, folds)
        )
        for group, own in (SIGNALS.items() if split else ())
        if set(own) <= set(names)
    }
    trees = tree().fit(np.column_stack([features[n] for n in names]), residual)
    # as much of it as it was worth on the folds left out: trees know nothing of a time to come
    guess = trees.predict(np.column_stack([held[n] for n in names]))
    rest = other - worth(residual, residual - whole) * guess
    orders, power = spectrum(residual, train.signals()["angle"], 0.01, 100.0)
    top = int(np.argmax(power)) if len(power) else 0
    order, wave = (float(orders[top]), float(power[top])) if len(power) else (0.0, 0.0)
    return Ceiling(whole, rest, share(residual, whole), alone, order, wave)


def depends_on(found: Ceiling) -> str:
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
