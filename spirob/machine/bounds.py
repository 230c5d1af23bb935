"""Bounds of the numbers in a description, and what comes of numbers that lie beyond them.

A wrong unit or factor moves all numbers of a machine alike.  Where the logs themselves say that it
is many times off, the numbers are looked for where they are; a little beyond, they are set free
once a search has ended at the bounds.
"""

import numpy as np

from spirob.diagnosis.model import Model
from spirob.machine.checks import TENFOLD
from spirob.machine.inverse import InverseProblem
from spirob.machine.models import RigSearch
from spirob.machine.odd_logs import FAMILIAR, HALF, RESISTING, beside_plain, plain_columns
from spirob.machine.preparation import Ready
from spirob.machine.rig import Bounded, RigFile
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
