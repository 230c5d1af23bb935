"""Names that do not hold when the motion is foretold: those of laws that swing by themselves.

From the motion to the effort such a law is a filter, and under an effort of one line, a sine, a
filter that smooths the motion takes what friction or noise leaves there.  Forward it is a load on a
spring, which the measured effort has to move as the axis moved; where the filter leaves the motor
no inertia, it runs away.
"""

from collections.abc import Collection

from spirob.diagnosis.criteria import HALVED
from spirob.diagnosis.model import Model
from spirob.effects import Effect
from spirob.machine.forward import Forward
from spirob.machine.forward.axis import PORTS
from spirob.machine.models import RigSearch


def misleading(search: RigSearch, chosen: Model, names: Collection[str]) -> list[str]:
    """Those of the names with which held-out motion is foretold far worse than without.

    Far worse: without it half of the squared error is left, of the speed within half a second.
    """
    asked = [e for e in chosen.effects if e.name() in names and _swings(e)]
    if not asked:
        return []
    run = Forward(search.models.heldout)
    return [e.name() for e in asked if _is_worse(run, search.without(chosen, e), chosen)]


def _swings(effect: type[Effect]) -> bool:
    """Whether it may begin with any state, and acts on the torque that moves the axis."""
    return bool(effect.free) and effect.port in PORTS


def _is_worse(run: Forward, without: Model, chosen: Model) -> bool:
    models = without.fit.changes, chosen.fit.changes
    if any(run.absent(changes) for changes in models):
        return False
    before, after = (run.missed(changes) for changes in models)
    return before < HALVED * after
