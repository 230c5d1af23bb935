"""Which laws could stand in the place of a chosen effect: rivals, and those that say the same.

How dry friction turns round is no difference between machines that a log has to tell: its plainest
law is a rival, or the same, though it has a number more.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from spirob.diagnosis.model import ALIKE, Model, is_dry, richness
from spirob.effects import Effect

if TYPE_CHECKING:
    from spirob.diagnosis.search import Search


def rivals(search: Search[Any], model: Model, effect: type[Effect]) -> list[Model]:
    """Exchanges of an effect that are not clearly worse, nor richer; or better held out.

    What the fitted trials prefer, though the held-out ones prefer another by what counts, these
    data do not tell.
    """
    plainest = min(filter(is_dry, search.candidates), key=richness, default=None)

    def stands(other: Model) -> bool:
        plain = other.numbers <= model.numbers or plainest in other.effects
        return (plain and not is_worse(search, other, model)) or search.worth.rises(other, model)

    found = [m for m in search.exchanges(model, effect) if stands(m)]
    return [*found, *_richer(search, model, effect)]


def alike(search: Search[Any], model: Model, effect: type[Effect]) -> list[str]:
    """Laws as rich as an effect, or the plainest dry friction, that these data show as it.

    They promise as much, and the model with the effect can make what they do, without it it
    cannot.  A richer law that contains the chosen one would say the same always.  Dry friction
    contains no law but its own kind: where it is the same, as in logs of one direction, the
    data say so.
    """
    lesser, own = search.without(model, effect), richness(effect)
    other = [e for e in search.absent(lesser) if richness(e) == own or is_dry(e)]
    errors = {o.effect: o.error for o in search.offers(lesser, [effect, *other])}
    enough = errors.pop(effect, 0.0) + (ALIKE * search.worth.least) ** 2
    as_good = [e for e, error in errors.items() if error <= enough]
    made = [e for e in as_good if search.models.absorbs(model, e)]
    dry = [] if is_dry(effect) else sorted(filter(is_dry, made), key=richness)[:1]
    return [e.name() for e in made if richness(e) == own or e in dry]


def is_worse(search: Search[Any], other: Model, model: Model) -> bool:
    """Whether another model is clearly worse, or worse held out."""
    return search.worth.clearly(other, model) or search.worth.refuted(other, model)


def _richer(search: Search[Any], model: Model, effect: type[Effect]) -> list[Model]:
    """Models with another law of dry friction that halve what is left, though it is small.

    What they gain is too little to name them by, and too much to be sure of the simpler law.
    """
    made, related = [], search.models.related
    for other in search.candidates if is_dry(effect) else ():
        if not is_dry(other) or other.name() in model.names:
            continue
        rest = tuple(e for e in model.effects if e is not effect)
        kept = model.effects if not related(other, model.effects) else rest
        if not related(other, kept):
            made.append(search.models.fitted((*kept, other), model.fit.changes))
    return [m for m in made if search.models.plain(m) and search.worth.halves(model, m)]
