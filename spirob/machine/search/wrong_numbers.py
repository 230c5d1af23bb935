"""Numbers of a description that the logs contradict: beyond their bounds, or many times off.

A wrong unit or factor moves all numbers of a machine alike.  Where the logs themselves say that it
is many times off, the numbers are looked for where they are; a little beyond, they are set free
once a search has ended at the bounds.

What a mass asks of the drive is linear in it.  A factor of one body, or of all that the description
asks for, is told where it is nearer to ten than to one, and where it makes inertia and friction
beside it fit; otherwise a payload, a spring or a law may be what is missing.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from spirob.diagnosis.model import Model
from spirob.machine.description.rig import Bounded, RigFile
from spirob.machine.inverse.body import RigidBody
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.recordings.checks import TENFOLD
from spirob.machine.search.models import RigSearch
from spirob.machine.search.odd_logs import FAMILIAR, HALF, RARE, level
from spirob.machine.search.plain_columns import (
    RESISTING,
    beside_plain,
    explained,
    plain_columns,
    plain_numbers,
)
from spirob.machine.search.preparation import Ready
from spirob.units import PREFIX

ALIKE = ("inertia", "viscous", "stiffness")  # numbers that a factor of the effort scales


def in_scale(ready: Ready) -> Ready:
    """A rig with its numbers where the logs have them, if all of them are many times off.

    What inertia or body ask of the drive by the description is taken a number of times to explain
    the effort, beside the plain columns.  Where that number lies `TENFOLD` beyond what the
    description allows, and leaves less than half of what this would, the scale, or else the numbers
    that a factor of the effort scales, begin there, in bounds as wide as a unit's prefix may be
    wrong.
    """
    fit, (low, high) = ready.rig.fit, _allowed(ready)
    if low == high:
        return ready
    effort, asked, plain = _columns(ready)

    def fitted(column: np.ndarray, low: float, high: float) -> tuple[float, float]:
        numbers, left = beside_plain(effort, plain, RESISTING - 1, column[:, None], (low, high))
        return float(numbers[0]), left

    times, left = fitted(asked, 0.0, np.inf)
    familiar = left <= (1.0 - FAMILIAR) * float(np.var(effort))
    if not familiar or low / TENFOLD <= times <= high * TENFOLD:
        return ready
    if left > HALF * min(fitted(0.0 * asked, 0.0, np.inf)[1], fitted(asked, low, high)[1]):
        return ready
    if "scale" in fit:
        moved = ready.told(fit={**fit, "scale": released(_scaled(fit["scale"], 1.0 / times))})
        return moved.with_logs(ready.train, ready.test)
    scaled = {name: released(_scaled(fit[name], times)) for name in ALIKE if name in fit}
    return ready.told(fit={**fit, **scaled})


def _allowed(ready: Ready) -> tuple[float, float]:
    """Between how many times what the description asks for the effort may be by its bounds."""
    fit, low, high = ready.rig.fit, 1.0, 1.0
    if ready.body is None and "inertia" in fit and fit["inertia"].nominal > 0.0:
        own = fit["inertia"]
        low, high = own.low / own.nominal, own.high / own.nominal
    if "scale" in fit:
        own = fit["scale"]
        if own.nominal <= 0.0:
            return 1.0, 1.0
        low *= own.nominal / own.high
        high = high * own.nominal / own.low if own.low > 0.0 else np.inf
    return low, high


def _columns(ready: Ready) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """The effort, what inertia or body ask of it, and the plain columns beside that, (N,) each."""
    about = ready.sizes, ready.rest_speed
    problem = InverseProblem(ready.rig, ready.body, ready.train, (), *about, work=ready.work)
    begin = {n: b.nominal * (n in ("inertia", "scale")) for n, b in ready.rig.fit.items()}
    effort = problem.measured()
    asked = problem({f"rig.{name}": value for name, value in begin.items()}) + effort
    plain = plain_columns(problem)[1:]
    if ready.body is not None:  # it knows its weight
        plain = plain[:RESISTING]
    return effort, asked, plain


def _scaled(known: Bounded, times: float) -> Bounded:
    """So many times a number, of whatever size."""
    low, nominal, high = (times * end for end in (known.low, known.nominal, known.high))
    return Bounded.model_construct(low=low, nominal=nominal, high=high)


def beyond_bounds(search: RigSearch, chosen: Model) -> list[str]:
    """Names of the rig's own numbers that ended at a bound, but for a 0 that they may be."""
    found = []
    for name in search.models.names:
        estimate, about = chosen.fit.estimates[name], search.models.train.table.about[name]
        at_zero = about.low == 0.0 and estimate.value < 0.5 * about.high
        if name.startswith("rig.") and estimate.at_bound and not at_zero and name != "rig.delay":
            found.append(name.removeprefix("rig."))
    return found


def released(known: Bounded) -> Bounded:
    """Wider bounds of a number, by as much as a unit's prefix may be wrong."""
    low = 0.0 if known.low >= 0.0 else PREFIX * known.low
    high = PREFIX * max(abs(known.high), abs(known.low))
    return Bounded.model_construct(nominal=known.nominal, low=low, high=high)


def set_free(search: RigSearch, chosen: Model, rig: RigFile) -> list[str]:
    """What came of numbers whose bounds in the description held them."""
    said = []
    for name, given in rig.fit.items():
        found = chosen.fit.estimates[f"rig.{name}"]
        if given.low <= found.value <= given.high:
            continue
        told = found.low > 0.0 and not (found.low <= given.high and given.low <= found.high)
        why = "is a unit or a factor wrong?" if told else "these logs do not tell it."
        said.append(
            f"{name} ended at its bound, so it was set free: {found.value:.3g} {found.unit} "
            f"({found.low:.3g} to {found.high:.3g}), where {given.low:g} to {given.high:g} are "
            f"given; {why}"
        )
    return said


@dataclass(frozen=True)
class _Tried:
    """A factor of one body, or of the whole model file, and the share that is explained with it."""

    body: str
    factor: float
    share: float

    def said(self, as_described: float) -> str:
        """Both figures."""
        most, least = f"{self.share:.0%}", f"{max(0.0, as_described):.0%}"
        if not self.body:
            return (
                f"The effort is {self.factor:.3g} times what the description asks for: with that "
                f"factor it explains {most} of the variance, as described {least}."
            )
        return (
            f"With body '{self.body}' {self.factor:.3g} times as heavy as in its model file "
            f"{most} of the effort's variance is explained, as described {least}."
        )


def out_of_scale(search: RigSearch, chosen: Model) -> str:
    """What of a description is many times off, where no law found fits as well; or empty."""
    problem = search.models.train
    rig = problem.rig
    known = problem.body is not None or (rig.known.get("inertia", 0.0) > 0.0)
    if not known or "scale" in rig.fit:
        return ""
    if not search.worth.possible(chosen, 0.0, search.models.promised):
        return ""
    zero = {name: 0.0 for name in search.models.names if name != "rig.scale"}
    measured = problem.measured()
    asked = problem(zero) + measured
    as_described = _resisted(problem, measured, asked, np.zeros((len(asked), 0)))[0]
    whole = _tried(problem, measured, asked, "", asked)
    bodies = [
        _tried(problem, measured, asked, name, column)
        for name, column in (_weighed(problem, problem.body, zero) if problem.body else ())
    ]
    best = max([whole, *bodies], key=lambda tried: tried.share)
    if 1.0 - best.share > HALF * (1.0 - whole.share):
        best = whole
    enough = 1.0 - best.share <= HALF * (1.0 - max(as_described, found_of(search, chosen)))
    far = best.factor > 0.0 and not 1.0 / TENFOLD < best.factor < TENFOLD
    return best.said(as_described) if far and enough and best.share >= FAMILIAR else ""


def found_of(search: RigSearch, chosen: Model) -> float:
    """Share of the effort's variance that what was found explains, of held-out logs as well.

    These count about the level of all: a log at nearly one effort has no variance of its own.
    """
    train, heldout = search.models.train, search.models.heldout
    held, spread = heldout.measured(), max(float(np.var(train.measured())), 1e-300)
    confirmed = explained(held, held + chosen.heldout, level((train, heldout)))
    return min(1.0 - chosen.mean_square / spread, confirmed)


def _tried(
    problem: InverseProblem, measured: np.ndarray, asked: np.ndarray, name: str, column: np.ndarray
) -> _Tried:
    share, (more,) = _resisted(problem, measured, asked, column[:, None])
    return _Tried(name, 1.0 + float(more), share)


def _resisted(
    problem: InverseProblem, measured: np.ndarray, asked: np.ndarray, columns: np.ndarray
) -> tuple[float, np.ndarray]:
    """The share of the effort explained by `asked`, by what resists, a force and columns (N, k).

    Also their numbers, (k,).  Where there is no body, whose inertia is another and
    which knows its weight, a known inertia is all of it, and a weight and a spring are free.
    """
    plain, resisting = plain_columns(problem)[: RESISTING + 1], RESISTING
    if problem.body is None:
        plain, resisting = plain_columns(problem)[1:], RESISTING - 1
    numbers, left = beside_plain(measured - asked, plain, resisting, columns)
    return 1.0 - left / max(float(np.var(measured)), 1e-300), numbers


def _weighed(
    problem: InverseProblem, body: RigidBody, changes: dict[str, float]
) -> Iterator[tuple[str, np.ndarray]]:
    """Each body whose mass the drive feels, with what that asks of the effort, (N,)."""
    pieces = [piece for recording in problem.recordings for piece in recording.pieces]
    for name in body.heavy:
        doubled = np.concatenate([body.doubled(name, piece) for piece in pieces])
        column = -problem.shown(doubled - problem.asked.motion.body["load"], changes)
        if np.any(column):
            yield name, column


def without_sign(search: RigSearch, chosen: Model) -> str:
    """That the size of the effort may have been logged, its direction elsewhere; or empty.

    It has one sign though the axis moves both ways by similar amounts, and inertia, friction and
    weight leave less than half the squared error where it has the sign of the speed.  A weight that
    holds its sign fits as logged.  A chain, a cable or a propeller has one sign, too: its drive
    holds against what pulls back, and with the sign of the speed nothing fits the way back.  So
    both ways have to show it, held out as well.  Not where what was found halves what is left.
    """
    problem, heldout = search.models.train, search.models.heldout
    effort, speed = problem.measured(), problem.signals()["speed"]
    sums = [float(np.sum(np.maximum(way * s, 0.0))) for s in (effort, speed) for way in (1, -1)]
    one_sign = min(sums[:2]) <= RARE * max(sums[:2])
    if not one_sign or min(sums[2:]) < HALF * max(sums[2:]):
        return ""
    plain = plain_columns(problem)
    numbers = [plain_numbers(e, plain, RESISTING) for e in (_directed(problem), effort)]
    everywhere = _left(problem, numbers, np.ones(len(effort), bool))
    ways = [left for p in (problem, heldout) for left in _left_each_way(p, numbers)]
    fits = all(
        signed <= min(1.0 - FAMILIAR, HALF * logged) for signed, logged in (everywhere, *ways)
    )
    signed, logged = everywhere
    left = (1.0 - found_of(search, chosen)) * float(np.var(effort)) / float(np.mean(effort**2))
    if not fits or left < HALF * signed:
        return ""
    return (
        "The effort has one sign while the axis moves both ways. With the sign of the speed "
        f"inertia, friction and weight leave {np.sqrt(signed):.0%} of it, as it is "
        f"{np.sqrt(logged):.0%}: was it logged without its sign?"
    )


def _directed(problem: InverseProblem) -> np.ndarray:
    """The size of the effort with the sign of the speed, (N,)."""
    speed = problem.signals()["speed"]
    return np.asarray(np.abs(problem.measured()) * np.tanh(speed / problem.rest_speed))


def _left_each_way(
    problem: InverseProblem, numbers: Sequence[np.ndarray]
) -> list[tuple[float, float]]:
    """What `_left` tells of either direction of motion that there is."""
    speed = problem.signals()["speed"]
    ways = [way * speed > problem.rest_speed for way in (1, -1)]
    return [_left(problem, numbers, rows) for rows in ways if np.mean(rows) > RARE]


def _left(
    problem: InverseProblem, numbers: Sequence[np.ndarray], rows: np.ndarray
) -> tuple[float, float]:
    """Shares of the square of some rows, a mask (N,), left of the directed effort and as logged.

    numbers  of the plain columns, (k,) for either
    """
    columns, effort = np.column_stack(plain_columns(problem)), problem.measured()
    missed = [e - columns @ n for e, n in zip((_directed(problem), effort), numbers, strict=True)]
    size = max(float(np.mean(effort[rows] ** 2)), 1e-300)
    signed, logged = (float(np.mean(one[rows] ** 2)) / size for one in missed)
    return signed, logged
