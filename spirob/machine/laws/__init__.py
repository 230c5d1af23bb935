"""Laws between the motor and its load, for a plain axis that carries no tendon.

The library's laws of these effects act on a tendon's length, which a plain axis does not have; here
they are the torque that the motor feels.  Their names are the library's: it is the same effect.
"""

from collections.abc import Iterable

from spirob.effects import Effect
from spirob.machine.laws.backlash import Backlash
from spirob.machine.laws.gear_compliance import GearCompliance

AXIS: dict[str, type[Effect]] = {law.name(): law for law in (Backlash, GearCompliance)}
INERTIA = "N·m·s²/rad"  # of a number that says how much of the moved inertia is the load's


def for_axis(effects: Iterable[type[Effect]]) -> list[type[Effect]]:
    """The same effects, each by its law for an axis where there is one."""
    return [AXIS.get(e.name(), e) if e.__module__.startswith("spirob.") else e for e in effects]


def shares_inertia(effect: type[Effect]) -> bool:
    """Whether this law lets a part of the moved inertia move otherwise than the motor."""
    return any(about.unit == INERTIA for about in effect.parameters().values())
