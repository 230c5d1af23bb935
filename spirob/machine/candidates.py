"""Which effects can act on a rig, and why the others cannot."""

from collections.abc import Collection, Sequence
from itertools import combinations
from math import prod

import numpy as np

from spirob.diagnosis.model import Model, another_dry
from spirob.effects import Effect
from spirob.identify.fit import Fit
from spirob.machine.laws import LEVER, shares_inertia
from spirob.machine.rig import RigFile
from spirob.machine.scaling import Sizes, parameters
from spirob.machine.shapes import counts_periods, reads_a_disc, waves

DRIVE = {  # port -> what it is, for rigs whose effort a sensor takes behind the motor
    "motor.drive_torque": "the motor's torque per ampere",
    "winch.efficiency": "the gear's efficiency",
    "sensing.current": "the drive's current sensor",
    "sensing.report": "the drive's report of its current",
}
ALWAYS = {"motor.torque", "tendon.force", "sensing.displacement"}
PLACED = {"motor.angle", "winch.displacement", "hinge.angle"}
SIGNALS = {
    "time",
    "motor.rest_speed",
    "motor.current",
    "motor.speed",
    "motor.angle",
    "motor.load_torque",
    "motor.inertia_torque",
    "winch.displacement",
}
HINGE = {
    "hinge.angle",
    "hinge.speed",
    "hinge.stiffness",
    "hinge.weight_x",
    "hinge.weight_y",
}


def applicable(
    effects: Sequence[type[Effect]], rig: RigFile, has_tip: bool, stiffness: float, angular: bool
) -> tuple[list[type[Effect]], dict[str, str]]:
    """The effects that this rig can show, and name -> reason for those that it cannot."""
    possible, excluded = [], {}
    for effect in effects:
        reason = _reason(effect, rig, has_tip, stiffness, angular)
        if reason:
            excluded[effect.name()] = reason
        else:
            possible.append(effect)
    return possible, excluded


def with_room(
    effects: Sequence[type[Effect]], sizes: Sizes
) -> tuple[list[type[Effect]], dict[str, str]]:
    """The effects that a motion of this size can show, and name -> reason for the others."""
    possible, excluded = [], {}
    for effect in effects:
        closed = [n for n, about in parameters(effect, sizes).items() if not about.low < about.high]
        if closed:
            excluded[effect.name()] = (
                f"the motion is too small to show it: nothing is left between the bounds of its "
                f"number '{closed[0]}'"
            )
        else:
            possible.append(effect)
    return possible, excluded


def _reason(
    effect: type[Effect], rig: RigFile, has_tip: bool, stiffness: float, angular: bool
) -> str:
    port, reads = effect.port, set(effect.reads.values())
    hinged = not isinstance(rig.body, str)
    if rig.position is None and (reads & PLACED or port == "sensing.displacement"):
        return "the log has no position"
    if shares_inertia(effect) and not (hinged or "inertia" in rig.fit or rig.known.get("inertia")):
        return "the rig moves no inertia that could stay behind"
    if port == "command.current" and rig.effort.origin != "command":
        return "the log holds no commanded effort to compare with"
    if port == "sensing.report" and rig.effort.origin == "command":
        return "a logged command is no report of a current"
    if port == "sensing.frame" and reads:
        return "the frame of a bus is not in the log"
    if port in DRIVE and rig.effort.origin == "sensor":
        return f"{DRIVE[port]} lies before the sensor that measures this effort"
    if port == "body.tip_mass":
        return "" if has_tip else "the rig's body has no tip that carries anything"
    if effect in LEVER.values():
        return ""
    if port == "body.hinge_torque":
        if not hinged or not angular:
            return "the rig has no hinged body"
        if "hinge.stiffness" in reads and stiffness <= 0.0:
            return "the driven joint has no spring"
        return _unread(reads - SIGNALS - HINGE)
    if port not in ALWAYS | set(DRIVE) | {"command.current", "sensing.frame"}:
        return f"the rig has no {port.replace('.', ' ')}"
    missing = reads - SIGNALS - ({"motor.command"} if rig.effort.origin == "command" else set())
    return _unread(missing)


def _unread(missing: set[str]) -> str:
    return f"the log has no {', '.join(sorted(missing))}" if missing else ""


def related(effect: type[Effect], others: Collection[type[Effect]]) -> bool:
    """Whether one of the others is the same kind of law, of which a machine has only one.

    One load stays behind the motor in one way: play has its teeth's spring already.  A gear's teeth
    lose by their load in one way, which friction by the load and an efficiency by direction tell.
    """
    for kind in (shares_inertia, _loses_by_load):
        if kind(effect):
            return any(kind(other) for other in others)
    return another_dry(effect, others)


def _loses_by_load(effect: type[Effect]) -> bool:
    """Whether this is a loss in proportion to the load that turns round with the motion."""
    reads = set(effect.reads.values())
    loaded = effect.port == "winch.efficiency" or "motor.load_torque" in reads
    return loaded and "motor.speed" in reads


def same_wave(model: Model, sizes: Sizes) -> bool:
    """Whether two of a model's effects are waves of one order, as far as the stroke can tell.

    Each of several laws can ripple at the same order; two of them together fit the edges of any.
    """
    apart = _apart(sizes)
    orders = [
        model.fit.changes[f"{e.name()}.{f}"]
        for e in model.effects
        for f in e.parameters()
        if f not in e.neutral and counts_periods(e, f)
    ]
    return any(abs(one - two) < apart for one, two in combinations(orders, 2))


def repeated_waves(effects: Sequence[type[Effect]], fit: Fit, sizes: Sizes) -> list[str]:
    """Numbers of waves of an effect that come at the order of another of its waves.

    Two waves that the stroke cannot tell apart are one wave.  Fitted as two, of opposite signs,
    they beat: a curve that fades in and out along the way, which no periodic law is.
    """
    found: list[str] = []
    for effect in effects:
        kept: dict[str, float] = {}  # numbers of the waves that stay -> order of one of them
        for amplitudes, shape in waves(effect):  # type: ignore[arg-type] # a class is hashable
            fitted = [f"{effect.name()}.{f}" for f in (*amplitudes, *shape)]
            if not all(name in fit.estimates for name in fitted):
                continue
            order = prod(fit.changes[name] for name in fitted[len(amplitudes) :])
            if any(abs(order - other) < _apart(sizes) for other in kept.values()):
                found += [name for name in fitted if name not in kept]
            else:
                kept |= dict.fromkeys(fitted, order)
    return found


def _apart(sizes: Sizes) -> float:
    """By how much orders differ that the stroke tells apart: a period of it."""
    return float(2 * np.pi * sizes.angle / sizes.stroke)


def seldom_seen(model: Model) -> bool:
    """Whether a wave of the model ends as long as the bounds of its order let it.

    They let it come round twice on the way: two periods are needed to give its length.  What would
    be longer still comes round less, and is a curve of the place, as any other.
    """
    for effect in model.effects:
        names = {f: f"{effect.name()}.{f}" for f in effect.fitted() if f not in effect.neutral}
        told = {f: model.fit.estimates[n] for f, n in names.items() if n in model.fit.estimates}
        orders = [told[f] for f in told if counts_periods(effect, f)]
        slowest = any(o.at_bound and o.value - o.low < o.high - o.value for o in orders)
        if slowest and not reads_a_disc(effect):
            return True
    return False
