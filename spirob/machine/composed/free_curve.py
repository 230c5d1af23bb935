"""Is a law of dry friction bent as the machine's is?  A free curve over the speed tells.

    τ = -Σ_k c_k·w_k(√(|v|/v_max))·sign(v),   w_k bumps evenly apart, none of them at standstill

beside the fitted law and numbers, each fold predicted from the others.  Near standstill every law
turns round in its own way, which says nothing of its level.
"""

from spirob.diagnosis.dry import is_dry
from spirob.diagnosis.model import Model
from spirob.machine.composed.draft import Draft, Drafts
from spirob.machine.composed.grammar import WAY, Shape, Term
from spirob.machine.composed.ground import ground_of
from spirob.machine.models import RigSearch

BUMPS = 5


def freed(search: RigSearch, model: Model) -> Draft:
    """The model with a level that may follow any curve over the speed."""
    parts = tuple(
        f"way*(0.5 + 0.5*cos(pi*Max(-1.0, Min(1.0, {float(BUMPS)!r}*share**0.5 - {float(k)!r}))))"
        for k in range(1, BUMPS + 1)
    )
    ground = ground_of(search, list(model.fit.estimates), model.fit.changes)
    return Drafts(ground).made((Term((Shape(WAY, "speed", parts),)),))


def is_bent(search: RigSearch, model: Model) -> bool:
    """Whether a free curve halves what is left of a model with dry friction, by what counts."""
    if not any(is_dry(effect) for effect in model.effects):
        return False
    free, worth = freed(search, model), search.worth
    return worth.matters(model, free) and worth.halves(model, free)
