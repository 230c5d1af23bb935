"""What is left of a rig's model: how much could still be explained, from what, and in words.

Boosted trees predict the residual on folds left out from the signals of the motion alone.  What
they find is no law, but a ceiling: where they find nothing, no effect of these signals is missing;
and the signals that they need describe an effect that the library does not hold.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from spirob.diagnosis.criteria import noise_floor
from spirob.diagnosis.flexible import NOTHING, left_out, named, share, tree, worth
from spirob.diagnosis.model import Left, Model
from spirob.diagnosis.orders import spectrum
from spirob.diagnosis.verdict import TWICE
from spirob.machine.inverse.problem import InverseProblem

if TYPE_CHECKING:
    from spirob.machine.inverse.problem import InverseProblem
    from spirob.machine.search.models import Models

TALL = 0.3  # of the structured part: a wave that holds so much of it is worth a sentence
SIGNALS = {
    "position": ("position",),
    "speed": ("speed", "direction"),
    "acceleration": ("acceleration",),
    "time": ("time",),
}
SOME = 0.25  # of what is left follows from the motion: worth a sentence
LEAST_SHARE = 0.25  # of the squared residual that motion must explain to speak of a missing effect
# of the effort's RMS, and times the noise: three quarters of the square are then no noise
MUCH, NOISY = 0.1, 2.0

TURNS = {"rad": "a turn of the axis", "m": "the whole stroke"}  # where no gear is described


@dataclass(frozen=True)
class RigCeiling:
    """What a flexible residual explains on folds left out.

    left       (N,) residual that it leaves on the training trials
    heldout    (M,) the same on the held-out ones
    share      of the squared residual that it explains, 0 where it explains nothing
    order      periods in a turn of the strongest wave;  wave  its share
    turn       of what, in words
    by_signal  what tells the share that a group of signals explains by itself
    """

    left: np.ndarray
    heldout: np.ndarray
    share: float
    order: float
    wave: float
    by_signal: Callable[[], dict[str, float]]
    turn: str = "a turn of the motor"

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
    known = train.rig.position is not None and len(power)  # a speed tells no place to come back to
    top = int(np.argmax(power)) if known else 0
    order, wave = (float(orders[top]), float(power[top])) if known else (0.0, 0.0)
    turn = "a turn of the motor" if train.rig.gear else TURNS[train.sizes.axis_unit]
    return RigCeiling(whole, rest, share(residual, whole), order, wave, by_signal, turn)


def depends_on(found: RigCeiling) -> str:
    """What the residual depends on, as the middle of a sentence."""
    best = max(found.alone.values())
    said = f"on {named(found.alone)}" if best > NOTHING else "on several signals together"
    if found.wave > TALL * max(found.share, 0.1):
        said += f", with a wave of {found.order:.3g} periods in {found.turn}"
    return said


def _features(problem: InverseProblem) -> dict[str, np.ndarray]:
    signals = problem.signals()
    signals["direction"] = np.tanh(signals["speed"] / problem.rest_speed)
    told = ("position", "speed", "direction", "acceleration", "time")
    return {n: signals[n] for n in told if n != "position" or problem.rig.position is not None}


def left_of(models: "Models", model: Model, rest: RigCeiling) -> Left:
    """What is left of a model; `rest` is the ceiling over it."""
    follows = max(rest.share, share(model.heldout, rest.heldout))
    told = _said(follows, rest), _unknown(models, model, follows, rest)
    return Left(rest.share, *told)


def _noise(models: "Models") -> float:
    return max(float(noise_floor(models.train)), models.least)


def _said(follows: float, rest: RigCeiling) -> str:
    if follows < SOME:
        return (
            f"Of what is left, a flexible model of the motion explains {follows:.0%} of the square."
        )
    return (
        f"Of what is left, {follows:.0%} of the square still follows from the motion: it "
        f"depends {depends_on(rest)}."
    )


def drifting(
    train: "InverseProblem", heldout: "InverseProblem", model: Model, least: float
) -> list[str]:
    """That an effort which changes with the time of a log, at one rate in all, is much of the rest.

    measured = (c0 + c1·t)·modelled, with c from the training logs, has to take its share of what
    c0 alone leaves, of the held-out ones' squared error, too, and more than the least that counts.
    """
    left = model.fit.residual, model.heldout
    measured = [p.measured() for p in (train, heldout)]
    modelled = [m + rest for m, rest in zip(measured, left, strict=True)]
    seconds = (p.signals()["time"] for p in (train, heldout))
    grown = [np.column_stack([m, t * m]) for m, t in zip(modelled, seconds, strict=True)]
    whole, rate = np.linalg.lstsq(grown[0], measured[0], rcond=None)[0]
    scale = float(modelled[0] @ measured[0] / max(float(modelled[0] @ modelled[0]), 1e-300))
    scaled = [m - scale * own for m, own in zip(measured, modelled, strict=True)]
    taken = [
        share(rest, m - design @ (whole, rate))
        for rest, m, design in zip(scaled, measured, grown, strict=True)
    ]
    if min(taken) < SOME or taken[0] * float(np.mean(scaled[0] ** 2)) < least**2:
        return []
    return [
        f"A modelled effort that changes by {rate / whole:+.1%} a second in all logs takes "
        f"{taken[0]:.0%} of the squared error that a constant scale leaves, and {taken[1]:.0%} "
        "held out: does the effort's sensor drift, or is it heat? Names may come of it."
    ]


def _unknown(models: "Models", model: Model, follows: float, rest: RigCeiling) -> tuple[str, str]:
    missed = f"{float(np.sqrt(model.mean_square)) / models.size:.1%}"
    effort = models.train.effort.name
    if follows < SOME:
        return (
            "Something is missing that the library does not hold, and a flexible model of the "
            "motion does not find it.",
            f"The model misses {missed} of the {effort}'s RMS on data left out, far more than the "
            "sensors' noise. Of that squared error trees on position, speed, acceleration and time "
            f"explain {follows:.0%}: blows, chatter or a memory would look so, and so would logs "
            "that do not belong together.",
        )
    return (
        f"Something is missing that the library does not hold: it depends {depends_on(rest)}.",
        f"The model misses {missed} of the {effort}'s RMS on "
        f"data left out. A flexible model of the motion explains {follows:.0%} of that "
        f"squared error there; no effect of the library has its shape.",
    )


def nothing(models: "Models", rest: RigCeiling) -> str:
    """Why nothing is missing; `rest` is the ceiling over the fitted numbers alone."""
    effort = models.train.effort.name
    return (
        "No likely effect of the library lowers the error of the fitted numbers on data left "
        f"out by {models.least / models.size:.1%} of the {effort}'s RMS, and a flexible model of "
        f"the motion explains {rest.share:.0%} of the squared residual."
    )


def structured(models: "Models", model: Model, rest: RigCeiling) -> bool:
    """Whether what a model leaves follows from the motion, by a share and a size that count."""
    large = np.sqrt(rest.share * model.mean_square) >= TWICE * models.least
    return bool(large) and rest.share > LEAST_SHARE


def unexplained(models: "Models", model: Model) -> bool:
    """Whether far more is left than any noise, though no signal of this moment explains it.

    Blows, chatter and memories do not follow from the motion of this moment.  What is left of the
    held-out logs counts beside their own effort: they may be gentler than those that were fitted,
    and where they are, what those leave of theirs when left out counts as well.
    """
    size = float(np.sqrt(np.mean(models.heldout.measured() ** 2)))
    held, own = np.sqrt(model.heldout_square) / size, np.sqrt(model.mean_square) / models.size
    return noisy(models, model) and bool(max(held, own) > MUCH)


def noisy(models: "Models", model: Model) -> bool:
    """Whether most of the squared held-out error is no noise, and its size counts."""
    return bool(np.sqrt(model.heldout_square) > NOISY * _noise(models))
