"""Laws of a plain axis, which has neither a tendon nor, often, a model of its body.

The library's laws of these effects act on a tendon's length, or on a body that somebody
described; here they are the torque that the motor feels.  Their names are the library's: it is the
same effect.

backlash.py, gear_compliance.py  between motor and load; `load_side/` for a sensor at the load
direction_dependent_efficiency.py, load_dependent_friction.py  losses that turn round over a way,
                                 the latter of an axis whose motor's own inertia no gear carries
presliding_friction.py, stribeck_friction.py  bristles that are damped, or carry a Stribeck curve:
                                 in a loop of a millisecond they would be too stiff for the arm
tip_payload.py                   weight on a lever that no model file describes
"""

from collections.abc import Collection, Iterable

from spirob.diagnosis.model import another_dry, is_constant
from spirob.effects import Effect, all_effects
from spirob.machine.laws import load_side
from spirob.machine.laws.backlash import Backlash
from spirob.machine.laws.direction_dependent_efficiency import (
    DirectionDependentEfficiency,
    OfDescribedLoad,
)
from spirob.machine.laws.gear_compliance import GearCompliance
from spirob.machine.laws.load_dependent_friction import LoadDependentFriction
from spirob.machine.laws.presliding_friction import PreslidingFriction
from spirob.machine.laws.stribeck_friction import StribeckFriction
from spirob.machine.laws.tip_payload import TipPayload

AXIS: dict[str, type[Effect]] = {law.name(): law for law in (Backlash, GearCompliance)}
LOAD_SIDE: dict[str, type[Effect]] = {
    law.name(): law for law in (load_side.Backlash, load_side.GearCompliance)
}
FRICTION: dict[str, type[Effect]] = {
    law.name(): law for law in (PreslidingFriction, StribeckFriction)
}
LEVER: dict[str, type[Effect]] = {TipPayload.name(): TipPayload}
LOSSES: dict[str, type[Effect]] = {
    law.name(): law for law in (LoadDependentFriction, DirectionDependentEfficiency)
}
SPRING = "parallel_spring"
SHARE = "rotor_share"  # of the moved inertia that is the motor's own
TURNED = 1.0  # rad: over less, a weight on a lever is a spring with an offset
INERTIA = "N·m·s²/rad"  # of a number that says how much of the moved inertia is the load's


def for_axis(
    effects: Iterable[type[Effect]],
    turned: float = 0.0,
    side: str = "motor",
    shared: bool = True,
    given: bool = False,
) -> list[type[Effect]]:
    """The same effects, each by its law for an axis where there is one.

    turned  by how much an axis turns whose body nobody described [rad]; 0 where it slides
    side    where the position sensor sits, at the "motor" or at the "load"
    shared  whether a part of the load may be the motor's own inertia: not where a body is
            described, which carries the rest, or where no inertia is moved
    given   whether a body is described and the scale of the effort is not fitted
    """
    own = (LOAD_SIDE if side == "load" else AXIS) | FRICTION | (LOSSES if shared else _CARRIED)
    if turned >= TURNED:
        own = own | LEVER
    if given:
        own = own | {OfDescribedLoad.name(): OfDescribedLoad}
    return [own.get(e.name(), e) if e.__module__.startswith("spirob.") else e for e in effects]


def _carried(law: type[Effect]) -> type[Effect]:
    """The same of a load that holds nothing of the motor's."""
    own = {"__module__": law.__module__, "__doc__": law.__doc__, "held": {SHARE}}
    return type(law.__name__, (law,), own | {"kernel": staticmethod(law.kernel)})


_CARRIED = {n: _carried(w) if SHARE in w.parameters() else w for n, w in LOSSES.items()}


def by_module() -> dict[str, type[Effect]]:
    """Every law that the program holds, of the arm and of an axis, by the module that states it."""
    own = (law for laws in (AXIS, LOAD_SIDE, FRICTION, LEVER, LOSSES) for law in laws.values())
    return {law.__module__: law for law in (*all_effects().values(), *own)}


def shares_inertia(effect: type[Effect]) -> bool:
    """Whether this law lets a part of the moved inertia move otherwise than the motor."""
    return any(about.unit == INERTIA for about in effect.parameters().values())


def related(effect: type[Effect], others: Collection[type[Effect]]) -> bool:
    """Whether one of the others is the same kind of law, of which a machine has only one.

    One load stays behind the motor in one way: play has its teeth's spring already.  A gear's teeth
    lose by their load in one way, which friction by the load and an efficiency by direction tell.
    A spring holds a constant force, and beside a weight it is one that grows with the way.
    """
    if effect.name() == SPRING:
        return any(map(_is_of_a_spring, others))
    if _is_of_a_spring(effect):
        return any(other.name() == SPRING for other in others)
    for kind in (shares_inertia, _loses_by_load):
        if kind(effect):
            return any(kind(other) for other in others)
    return another_dry(effect, others)


def _is_of_a_spring(effect: type[Effect]) -> bool:
    """Whether a spring holds it already, or beside it would be no straight one."""
    return is_constant(effect) or effect in LEVER.values()


def _loses_by_load(effect: type[Effect]) -> bool:
    """Whether this is a loss in proportion to the load that turns round with the motion."""
    reads = set(effect.reads.values())
    loaded = effect.port == "winch.efficiency" or "motor.load_torque" in reads
    return loaded and "motor.speed" in reads
