"""What is left of a rig's model: how much follows from the motion, and from what, in words."""

from typing import TYPE_CHECKING

import numpy as np

from spirob.diagnosis.evidence import noise_floor
from spirob.diagnosis.flexible import share
from spirob.diagnosis.model import Left, Model
from spirob.diagnosis.verdict import TWICE
from spirob.machine.delays import DELAY, usual
from spirob.machine.flexible import RigCeiling, depends_on

if TYPE_CHECKING:
    from spirob.machine.inverse import InverseProblem
    from spirob.machine.models import Models

SOME = 0.25  # of what is left follows from the motion: worth a sentence
LEAST_SHARE = 0.25  # of the squared residual that motion must explain to speak of a missing effect
# of the effort's RMS, and times the noise: three quarters of the square are then no noise
MUCH, NOISY = 0.1, 2.0


def left_of(models: "Models", model: Model, rest: RigCeiling) -> Left:
    """What is left of a model; `rest` is the ceiling over it."""
    delay = model.fit.estimates.get(DELAY)
    period = max(r.period for r in models.train.recordings)
    late = float(np.log1p(abs(delay.value) / usual(period))) if delay else 0.0
    follows = max(rest.share, share(model.heldout, rest.heldout))
    told = _said(follows, rest), _unknown(models, model, follows, rest)
    return Left(max(rest.share, _beyond_noise(models, model)), late, *told)


def _beyond_noise(models: "Models", model: Model) -> float:
    """Share of the squared error that is no noise, where far more than noise is left; else 0.

    What trees do not find there (a memory, blows, a fit that ends at its bounds) is left, too.
    """
    if not unexplained(models, model):
        return 0.0
    return 1.0 - _noise(models) ** 2 / model.heldout_square


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
