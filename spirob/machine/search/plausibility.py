"""Do data and description fit together?  What has to be doubted, and what is left open.

A cause (a sign, a unit) is said only where mending it makes the model fit, with both figures;
otherwise what was found.

A sensor at the motor and one at the load, behind an elastic gear or one with play, see different
motions.  What is left of the model chosen for the one may be what the laws of the other take.
"""

from collections.abc import Sequence

import numpy as np
import scipy

from spirob.diagnosis.model import Found, Model, is_dry
from spirob.diagnosis.verdict import TWICE, Verdict
from spirob.identify.fit import Estimate
from spirob.identify.identifiability import Identifiability
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.laws import LOAD_SIDE
from spirob.machine.recordings.recording import Recording
from spirob.machine.search.delays import DELAY, usual
from spirob.machine.search.leftovers import RigCeiling, drifting
from spirob.machine.search.models import RigSearch
from spirob.machine.search.odd_logs import (
    FAMILIAR,
    FEWEST,
    OddLogs,
    level,
    odd_one_out,
    one_way,
    strangers,
    ways_apart,
)
from spirob.machine.search.plain_columns import RESISTING, explained, plain_columns
from spirob.machine.search.wrong_numbers import found_of, out_of_scale, set_free, without_sign

FAR = 20.0  # between a number and its nominal one, a stroke and that of all other logs
SENSE = 0.3  # R² below which the effort does not follow from this motion
HALF = 0.5  # of the squared error: mending the sign takes more than that
WEAK = 1e4  # ratio of directions beyond which the numbers cannot be told apart
SEEN = 0.2  # of a sample, of delay that is worth a word
UNUSUAL = (
    " That is more than cycles and clocks explain: a filter or a bus on the way to the log, or a "
    "lag or latency of the machine itself, which only `known: {delay: ...}` can tell apart."
)
LONG, FAST = 20.0, 5000.0  # m of stroke, rad/s: no motor rig of this kind
ANSWERS = (
    ", unless a controller answers the motion with this effort: then its law is seen, not the "
    "machine's, and excitation of its own has to be added to the command"
)
AT_LOAD = (
    "The logs fit a position sensor at the load, behind gear and shaft, better than one at the "
    "motor: taken so. position.side says where it sits."
)


def doubts(search: RigSearch, found: Found, rest: RigCeiling, believed: bool = True) -> list[str]:
    """Why no name can be trusted, whatever the errors say; empty where one can.

    believed  whether something found is likely: else it stands against no wrong sign or scale
    """
    stands = found.chosen if believed else found.rungs[0]
    causes = [told(search, stands) for told in (_turned, without_sign, out_of_scale)]
    causes.append(_computed(search, found.chosen))
    mended = [text for text in causes if text]
    odd = odd_logs(search, found)
    other = odd.said if odd else "" if mended else _senseless(search, found, rest)
    return [text for text in (other, *mended) if text]


def only_of_logs(search: RigSearch, found: Found, verdict: Verdict) -> OddLogs | None:
    """The logs that do not fit the others, where all doubts of a verdict are about them."""
    odd = odd_logs(search, found) if verdict.doubts else None
    return odd if odd and verdict.doubts == (odd.said,) else None


def odd_logs(search: RigSearch, found: Found) -> OddLogs | None:
    """The logs that do not fit the others."""
    problems = search.models.train, search.models.heldout
    residuals = found.chosen.fit.residual, found.chosen.heldout
    return odd_one_out(problems, residuals) or strangers(problems, residuals)


def oddities(
    search: RigSearch, chosen: Model, gate: Identifiability, rig: RigFile, fits: bool
) -> list[str]:
    """What a reader should know, though it changes no name: alignment, doubtful scales, bounds.

    Numbers of a model that leaves most of the effort say nothing.

    fits  whether data and model fit together: else nothing is aligned that could be told
    """
    said, tells = [], found_of(search, chosen) >= SENSE
    delay, period = chosen.fit.estimates.get(DELAY), search.models.train.recordings[0].period
    if fits and tells and delay is not None and abs(delay.value) > SEEN * period:
        said.append(aligned(delay, period))
    if gate.condition > WEAK:
        said.append(f"Some fitted numbers cannot be told apart by these logs: {gate.sentence}")
    said += _without_zeros(chosen)
    if tells:
        said += [*set_free(search, chosen, rig), *_heavy(search, chosen)]
        said += [*_of_another_size(search, chosen), *_by_noise(search, chosen)]
        said += drifting(search.models.train, search.models.heldout, chosen, search.worth.least)
    said += one_way(search.models.train, search.models.heldout)
    said += _far_movers((*search.models.train.recordings, *search.models.heldout.recordings))
    signals = search.models.train.signals()
    stroke, speed = float(np.ptp(signals["position"])), float(np.max(np.abs(signals["speed"])))
    if rig.position is not None and search.models.train.sizes.axis_unit == "m" and stroke > LONG:
        said.append(f"The axis travels {stroke:.3g} m: is the position's unit right?")
    if search.models.train.sizes.axis_unit == "rad" and speed > FAST:
        signal = "velocity" if rig.position is None else "position"
        said.append(f"The axis turns at {speed:.3g} rad/s: is the {signal}'s unit right?")
    return said


def aligned(delay: Estimate, period: float) -> str:
    """How effort and motion of logs were laid over one another; a bound is no measurement."""
    way, sign = ("trails", 1e3) if delay.value > 0 else ("leads", -1e3)
    size = f"{1e3 * abs(delay.value):.3g} ms"
    if delay.at_bound:
        return (
            "The delay between effort and motion is not told by these logs: it ended at the bound "
            f"of its search. An effort that {way} the motion by {size} was used."
        )
    if abs(delay.value) <= usual(period):
        return f"The effort {way} the motion by {size} in the logs; aligned."
    ends = " to ".join(f"{x:.3g}" for x in sorted((sign * delay.low, sign * delay.high)))
    return f"The effort {way} the motion by {size} ({ends}) in the logs; aligned.{UNUSUAL}"


def _far_movers(recordings: Sequence[Recording]) -> list[str]:
    """Logs in which the axis moves many times as far as in all others."""
    strokes = {r.name: max(float(np.ptp(p.q[p.use])) for p in r.pieces) for r in recordings}
    said = []
    for name, stroke in strokes.items() if len(strokes) >= FEWEST else ():
        most = max(other for rest, other in strokes.items() if rest != name)
        if stroke > FAR * most > 0.0:
            said.append(
                f"{name}: the axis moves {stroke / most:.3g} times as far as in any other log: is "
                "the unit of its position another?"
            )
    return said


def _without_zeros(chosen: Model) -> list[str]:
    """That logs tell no zero of their own, where nothing of a model depends on the position."""
    own = [k for k, name in enumerate(chosen.fit.estimates) if name.startswith("zero.")]
    if not own or np.any(chosen.fit.jacobian[:, own]):
        return []
    return ["per_log: nothing in the model depends on the position, so no zero of a log is told."]


def _of_another_size(search: RigSearch, chosen: Model) -> list[str]:
    """That an inertia or a scale is far from its nominal value, by its whole interval."""
    said = []
    for name in (n for n in ("rig.inertia", "rig.scale") if n in search.models.names):
        found, nominal = chosen.fit.estimates[name], search.models.train.table.about[name].nominal
        small, large = found.high < nominal / FAR, found.low > nominal * FAR
        if nominal > 0 and (small or large):
            end = f"{found.high / nominal:.2g} times its nominal value at most"
            if large:
                end = f"{found.low / nominal:.2g} times its nominal value at least"
            number = name.removeprefix("rig.")
            said.append(f"{number} comes out {end}: is a unit or a factor wrong?")
    return said


def _by_noise(search: RigSearch, chosen: Model) -> list[str]:
    """That the noise of the motion makes the inertia too small, by more than its interval says."""
    found, share = chosen.fit.estimates.get("rig.inertia"), search.models.noise[1]
    if found is None or found.value * share / (1.0 - share) <= found.high - found.value:
        return []
    return [
        f"Noise of the sensor is {share:.0%} of what the acceleration varies by, so the inertia is "
        f"about {share:.0%} too small; a lower filter.cutoff or a finer sensor mends it."
    ]


def _heavy(search: RigSearch, chosen: Model) -> list[str]:
    """That a payload weighs more than the body that carries it, as a wrong mass would, too."""
    body, payload = search.models.train.body, chosen.fit.estimates.get("tip_payload.mass")
    if body is None or payload is None or payload.value < body.mass:
        return []
    return [
        f"The payload weighs {payload.value / body.mass:.2g} times what all of "
        f"{body.body.mjcf} does: is a mass in it wrong?"
    ]


def untaught(search: RigSearch, chosen: Model, verdict: Verdict) -> str:
    """That held-out logs show what the fitted ones do not; empty where that brings no name.

    They leave twice what data left out of the fitted logs do, by more than counts.  A name is asked
    again where it leaves nothing that counts of the fitted logs.  Doubts stand, but those about a
    log that alone goes its way: what friction does there, no other can say.
    """
    left, held = chosen.mean_square, chosen.heldout_square
    differ = held > TWICE**2 * left and held - left > search.worth.least**2
    alone = ways_apart(search.models.train, search.models.heldout)
    enough = verdict.kind != "unknown" and left > search.worth.least**2
    if verdict.kind == "nothing_missing" or enough or not differ or (verdict.doubts and not alone):
        return ""
    return (
        f"The held-out logs leave {np.sqrt(held / left):.2g} times the error that is left of what "
        "no fit saw of the others: they show what these do not."
    )


def _senseless(search: RigSearch, found: Found, rest: RigCeiling) -> str:
    """The effort follows from the motion on no logs at all, even with a flexible model."""
    train, heldout, chosen = search.models.train, search.models.heldout, found.chosen
    follows = max(
        _followed(train, level([train]), chosen.mean_square, rest.left),
        _followed(heldout, level([train, heldout]), chosen.heldout_square, rest.heldout),
    )
    if follows < SENSE:
        return (
            f"Of data left out the motion explains only {max(0.0, follows):.0%} of the "
            "effort's variance, even with a flexible model: it is hardly the effort of this axis, "
            "or other joints load it while they move (a model file tells what they do: body)."
        )
    return ""


def _followed(
    problem: InverseProblem, about: float, mean_square: float, flexible: np.ndarray
) -> float:
    """Share of an effort's square about a level that a model, or a flexible one, explains."""
    spread = float(np.mean((problem.measured() - about) ** 2))
    left = min(mean_square, float(np.mean(flexible**2)))
    return 1.0 - left / spread if spread > 0 else 1.0


def _turned(search: RigSearch, chosen: Model) -> str:
    """Whether inertia and friction, which only resist, fit with the other sign alone.

    Not where as much of the effort as it is logged follows from what was found, held out as well,
    or less than counts is left of it.
    """
    effort, columns = search.models.train.measured(), plain_columns(search.models.train)
    design = np.column_stack(columns)
    size = np.linalg.norm(design, axis=0) + 1e-300
    low = np.r_[np.zeros(RESISTING), np.full(len(columns) - RESISTING, -np.inf)]
    shares = []
    for sign in (1.0, -1.0):
        bounds = (low, np.full(len(low), np.inf))
        found = scipy.optimize.lsq_linear(design / size, sign * effort, bounds)
        shares.append(explained(sign * effort, design / size @ found.x))
    as_logged, turned = shares
    as_logged = max(as_logged, found_of(search, chosen))
    gained = (turned - as_logged) * float(np.var(effort))
    counts = gained > search.worth.least**2 and 1.0 - turned <= HALF * (1.0 - as_logged)
    if turned < FAMILIAR or not counts:
        return ""
    commanded = search.models.train.rig.effort.origin == "command"
    return (
        "With the sign of the effort turned, inertia, friction and weight explain all but "
        f"{100.0 * (1.0 - turned):.2g}% of its variance, as it is all but "
        f"{100.0 * min(1.0, 1.0 - as_logged):.2g}%: give the effort or the motion the factor -1"
        f"{ANSWERS if commanded else ''}."
    )


def _computed(search: RigSearch, chosen: Model) -> str:
    """Whether a commanded effort follows the place as no machine does; empty where it does not.

    Neither inertia nor friction is told from none, though the motion is so fast that the given
    inertia would be seen.  A geared axis may hide its inertia, but not its friction as well.  What
    a spring, a weight and a constant do not make most of is not computed from the place.
    """
    train, fit, names = search.models.train, chosen.fit, ("rig.inertia", "rig.viscous")
    nil = [n in fit.estimates and fit.estimates[n].low <= train.table.about[n].low for n in names]
    resists = not all(nil) or any(map(is_dry, chosen.effects))
    if train.rig.effort.origin != "command" or not chosen.effects or resists:
        return ""
    effort, place = train.measured(), np.column_stack(plain_columns(train)[RESISTING:])
    if explained(effort, place @ np.linalg.lstsq(place, effort, rcond=None)[0]) < HALF:
        return ""
    inertia, nominal = fit.estimates["rig.inertia"], train.table.about["rig.inertia"].nominal
    given, none = (train(fit.changes | {"rig.inertia": value}) for value in (nominal, 0.0))
    asked = float(np.sqrt(np.mean((given - none) ** 2)))
    if asked * (1.0 - inertia.high / nominal) < TWICE * search.worth.least:
        return ""
    return (
        f"The effort follows the place without friction and without the inertia of {nominal:.3g} "
        f"{inertia.unit}, which would ask for {asked / search.models.size:.0%} of it (at most "
        f"{inertia.high:.2g} fit): is it computed from the place, by the controller's law?"
    )


def may_sit_at_load(rig: RigFile, search: RigSearch, chosen: Model) -> bool:
    """Whether a description leaves the side open and enough is left for it to matter."""
    opened = rig.position is not None and rig.position.side is None and isinstance(rig.body, str)
    return opened and search.worth.possible(chosen, 0.0, search.models.promised)


def fits_at_load(at_load: RigSearch, chosen: Model) -> bool:
    """Whether a law of the load's side halves what the model chosen for the motor's leaves.

    at_load  the search in which the sensor sits there

    Less would be too little to contradict what most descriptions mean: the edges of friction at a
    reversal look like a little play behind the sensor.
    """
    kept = tuple(e for e in chosen.effects if e.name() not in LOAD_SIDE)
    laws = [e for e in at_load.candidates if e in LOAD_SIDE.values()]
    grown = at_load.extended(kept, chosen.fit.changes, laws)
    return any(at_load.worth.halves(chosen, model) for model in grown)
