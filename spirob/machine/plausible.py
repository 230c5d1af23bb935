"""Do data and description fit together?  What has to be doubted before a name is believed."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from spirob.identify.identifiability import Identifiability
from spirob.machine.flexible import Ceiling
from spirob.machine.inverse import InverseProblem
from spirob.machine.models import Model
from spirob.machine.search import Found, Search

FAMILIAR, STRANGE = 0.7, 0.0  # R² of a log that the model fits, and of one of another machine
SENSE = 0.3  # R² below which the effort does not follow from this motion
WEAK = 1e4  # ratio of directions beyond which the numbers cannot be told apart
GIVEN = -0.1  # mean power over the product of RMS effort and speed: below, the axis drives
SCALE = 10.0  # between the effort and what a model file asks for
SEEN = 0.2  # of a sample, of delay that is worth a word
FAR = 20.0  # between a number and its nominal one
LONG, FAST = 20.0, 5000.0  # m of stroke, rad/s: no motor rig of this kind


def doubts(search: Search, found: Found, rest: Ceiling, gate: Identifiability) -> list[str]:
    """Why no name can be trusted, whatever the errors say; empty where one can."""
    said = [_senseless(search, found, rest), _backwards(search), _out_of_scale(search)]
    residuals = found.chosen.fit.residual, found.chosen.heldout
    said.append(strangers((search.train, search.heldout), residuals))
    if gate.condition > WEAK:
        said.append(f"The fitted numbers cannot be told apart: {gate.sentence}")
    return [text for text in said if text] + _at_bounds(search, found.chosen)


def oddities(search: Search, chosen: Model) -> list[str]:
    """What a reader should know, though it changes no name: alignment, and doubtful scales."""
    said = []
    delay = chosen.fit.estimates.get("rig.delay")
    if delay is not None and abs(delay.value) > SEEN * search.train.recordings[0].period:
        way = "trails" if delay.value > 0 else "leads"
        more = " or more" if delay.at_bound else ""
        said.append(
            f"The effort {way} the motion by {1e3 * abs(delay.value):.2g} ms{more} in the logs; "
            "aligned."
        )
    about = search.train.table.about
    for name in search.models.base:
        value, nominal = chosen.fit.estimates[name].value, about[name].nominal
        if name in ("rig.inertia", "rig.scale") and nominal > 0 and value > 0:
            ratio = value / nominal
            if not 1 / FAR < ratio < FAR:
                said.append(
                    f"{name.removeprefix('rig.')} comes out {ratio:.3g} times its nominal value: "
                    "is a unit or a factor wrong?"
                )
    signals = search.train.signals()
    stroke, speed = float(np.ptp(signals["position"])), float(np.max(np.abs(signals["speed"])))
    if search.train.sizes.axis_unit == "m" and stroke > LONG:
        said.append(f"The axis travels {stroke:.3g} m: is the position's unit right?")
    if search.train.sizes.axis_unit == "rad" and speed > FAST:
        said.append(f"The axis turns at {speed:.3g} rad/s: is the position's unit right?")
    return said


def _senseless(search: Search, found: Found, rest: Ceiling) -> str:
    """The effort does not follow from the motion at all, even with a flexible model."""
    spread = float(np.var(search.train.measured()))
    left = min(found.chosen.mean_square, float(np.mean(rest.left**2)))
    if spread > 0 and 1.0 - left / spread < SENSE:
        return (
            f"The motion explains only {max(0.0, 1 - left / spread):.0%} of the effort's variance, "
            "even with a flexible model: are the columns of two motors exchanged, or a unit wrong?"
        )
    return ""


def strangers(problems: Sequence[InverseProblem], residuals: Sequence[np.ndarray]) -> str:
    """Logs that the others' model does not fit at all; empty where there are none.

    residuals  of one model on the trials of each problem
    """
    shares: dict[str, float] = {}
    for problem, residual in zip(problems, residuals, strict=True):
        for recording, (start, stop) in zip(
            problem.recordings, pairwise(problem.edges), strict=True
        ):
            spread = float(np.var(problem.measured()[start:stop]))
            missed = float(np.mean(residual[start:stop] ** 2))
            shares[recording.name] = 1.0 - missed / max(spread, 1e-300)
    strange = [name for name, share in shares.items() if share < STRANGE]
    if not strange or max(shares.values()) < FAMILIAR:
        return ""
    return (
        f"{', '.join(strange)}: what fits the other logs does not fit this at all: is it of "
        "another motor, or are a sign, a unit or its columns others?"
    )


def _backwards(search: Search) -> str:
    """A rig takes power from its motor; where it gives some, a sign is wrong."""
    effort, speed = search.train.measured(), search.train.signals()["speed"]
    size = float(np.sqrt(np.mean(effort**2) * np.mean(speed**2)))
    if size > 0.0 and float(np.mean(effort * speed)) < GIVEN * size:
        return (
            "On the whole the axis drives the motor: the sign of position or effort is wrong (give "
            "one of them the factor -1), or the columns of two motors are exchanged."
        )
    return ""


def _out_of_scale(search: Search) -> str:
    """The effort is some orders of magnitude beside what the model file asks for."""
    if isinstance(search.train.rig.body, str) or "scale" in search.train.rig.fit:
        return ""
    zero = {name: 0.0 for name in search.models.base if name != "rig.scale"}
    asked, measured = search.train(zero) + search.train.measured(), search.train.measured()
    power = float(np.dot(asked, asked))
    if power == 0.0:
        return ""
    ratio = float(np.dot(asked, measured)) / power
    if 1 / SCALE < abs(ratio) < SCALE or abs(np.corrcoef(asked, measured)[0, 1]) < np.sqrt(SENSE):
        return ""
    return (
        f"The effort is {ratio:.3g} times what the model file asks for: a unit, a factor or "
        "known.scale is wrong."
    )


def _at_bounds(search: Search, chosen: Model) -> list[str]:
    said = []
    for name, estimate in chosen.fit.estimates.items():
        about = search.train.table.about[name]
        at_zero = about.low == 0.0 and estimate.value < 0.5 * about.high
        own = name in search.models.base and name != "rig.delay"
        if own and estimate.at_bound and not at_zero:
            said.append(
                f"{name.removeprefix('rig.')} ended at its bound, {estimate.value:.3g} "
                f"{estimate.unit}: the bounds, a unit or a factor are wrong."
            )
    return said
