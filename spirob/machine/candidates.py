"""Which effects can act on a rig, which say the same, and why the others cannot.

Effects that one rig cannot tell apart: their columns over its trials are the same.

Nothing is listed by name: two effects are equivalent on these data when one fitted in the place of
the other changes the modelled effort by less than the floor of an effect.
"""

from collections.abc import Collection, Sequence
from itertools import combinations

import numpy as np

from spirob.effects import Effect
from spirob.machine.laws import LEVER, shares_inertia
from spirob.machine.models import Model
from spirob.machine.rig import RigFile
from spirob.machine.scaling import Sizes, parameters
from spirob.machine.shapes import counts_periods

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


SPEEDS = {"motor.speed", "motor.rest_speed"}
SLOW, FAST = 1e3, 1e4  # rest speeds at which sliding friction has settled
LOW = (1.0, 3.0, 10.0)  # rest speeds among which a level is highest
HIGHER = 1.1
SETTLING = 100  # steps that a memory is given for that
STEP = 1e-3  # s


def is_dry(effect: type[Effect]) -> bool:
    """Whether this is a law of dry friction by speed alone: level at speed, and odd in it.

    Asked of the kernel itself, so that it holds for effects that nobody here has seen.
    """
    reads = set(effect.reads.values())
    if effect.port != "motor.torque" or "motor.speed" not in reads or not reads <= SPEEDS:
        return False
    slow, fast, back = (_settled(effect, v) for v in (SLOW, FAST, -FAST))
    return abs(fast) > 0.0 and abs(fast - slow) < 1e-3 * abs(fast) and fast * back < 0.0


def falls(effect: type[Effect]) -> bool:
    """Whether the level of a dry friction is higher at low speed than at high speed."""
    low = max(abs(_settled(effect, speed)) for speed in LOW)
    return low > HIGHER * abs(_settled(effect, FAST))


def _settled(effect: type[Effect], speed: float) -> float:
    given = {a: 1.0 if s == "motor.rest_speed" else speed for a, s in effect.reads.items()}
    given |= {f: p.nominal for f, p in effect.parameters().items()}
    given |= {"dt": STEP} if "dt" in effect.arguments() else {}
    memory = dict(effect.state)
    if not memory:
        return float(effect.kernel(**given))
    for _ in range(SETTLING):
        out = effect.kernel(**given, **memory)
        memory = dict(zip(memory, out[1:], strict=True))
    return float(out[0])


def related(effect: type[Effect], others: Collection[type[Effect]]) -> bool:
    """Whether one of the others is the same kind of law, of which a machine has only one.

    The sum of two laws of dry friction is a third one, with a transition that fits anything.  Only
    what they say of different things belongs together: how friction turns round at a reversal, and
    how its level falls with speed.  And one load stays behind the motor in one way: play has its
    teeth's spring already.
    """
    if shares_inertia(effect):
        return any(shares_inertia(other) for other in others)
    return is_dry(effect) and any(is_dry(o) and not _complete(effect, o) for o in others)


def _complete(one: type[Effect], other: type[Effect]) -> bool:
    """Whether one law tells how friction turns round, the other how its level falls with speed."""
    memory, level = (one, other) if one.state else (other, one)
    return bool(memory.state) and not level.state and falls(level)


def same_wave(model: Model, sizes: Sizes) -> bool:
    """Whether two of a model's effects are waves of one order, as far as the stroke can tell.

    Each of several laws can ripple at the same order; two of them together fit the edges of any.
    """
    apart = 2 * np.pi * sizes.angle / sizes.stroke
    orders = [
        model.fit.changes[f"{e.name()}.{f}"]
        for e in model.effects
        for f in e.parameters()
        if f not in e.neutral and counts_periods(e, f)
    ]
    return any(abs(one - two) < apart for one, two in combinations(orders, 2))


ALIKE = 0.1  # of the floor: by no more may two models differ that say the same


def alike(one: Model, two: Model, least: float) -> bool:
    """Whether two models predict the same effort, within a tenth of the least effect's RMS."""
    difference = one.fit.residual - two.fit.residual
    return float(np.sqrt(np.mean(difference**2))) < ALIKE * least


def equivalents(
    chosen: Model, rivals: Sequence[Model], least: float
) -> tuple[list[str], list[str]]:
    """Names of the effects that say the same as the chosen one, and of those that are real rivals.

    A rival counts as itself once, though it may be met several times.
    """
    same: list[str] = []
    other: list[str] = []
    for rival in rivals:
        name = next(iter(rival.names - chosen.names))
        (same if alike(chosen, rival, least) else other).append(name)
    return sorted(set(same)), sorted(set(other) - set(same))
