"""Dry friction beside the laws that these logs cannot tell it from."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from spirob.diagnosis.conclusion import Weighed
from spirob.diagnosis.model import Model, falls, is_constant, is_dry, richness
from spirob.diagnosis.rivals import is_worse
from spirob.diagnosis.verdict import plain
from spirob.effects import Effect
from spirob.machine.inverse.scaling import ways
from spirob.machine.search.models import RigSearch
from spirob.machine.search.odd_logs import one_way


def with_instant(
    search: RigSearch, chosen: Model, weighed: Mapping[str, Weighed]
) -> tuple[Mapping[str, Weighed], str]:
    """The weighed, dry friction that flips at once beside one whose way no log shows; what is said.

    A bristle that has turned round before the filter answers fits the sensor, not the friction:
    whether that has a peak beside rest, as other laws do, no such log shows, and they are rivals.
    A peak that flips at once is no bristle's.
    """
    unseen, told, said = search.models.train.sizes.unseen, dict(weighed), ""
    instant = _instant(search)
    for effect in chosen.effects if instant else ():
        name, other = effect.name(), instant[0].name()
        found = [chosen.fit.changes.get(f"{name}.{field}", np.inf) for field in ways(effect)]
        if not (is_dry(effect) and found and max(found) < unseen) or name not in weighed:
            continue
        if len(effect.neutral) > len(instant[0].neutral) and _at_once(search, chosen, effect):
            continue
        one, unit = weighed[name], search.models.train.sizes.axis_unit
        richer = (e.name() for e in search.candidates if is_dry(e) and e is not effect)
        told[name] = _with_same(replace(one, rivals=sorted({*one.rivals, *richer})), other)
        said = (
            f"{effect.title} would turn round within {max(found):.2g} {unit} of a reversal. The "
            f"axis goes {unseen:.2g} {unit} before the filter answers: these logs cannot tell it "
            f"from {plain(other)}."
        )
    return told, said


def _at_once(search: RigSearch, chosen: Model, effect: type[Effect]) -> bool:
    """Whether a law turns round within no way that its trials tell from none."""
    names = [f"{effect.name()}.{field}" for field in ways(effect)]
    lows = {n: search.models.train.table.about[n].low for n in names}
    return all(chosen.fit.estimates[n].low <= low for n, low in lows.items())


def _instant(search: RigSearch) -> list[type[Effect]]:
    """The plainest law of dry friction that flips at once, where there is one."""
    return sorted((e for e in search.candidates if is_dry(e) and not e.state), key=richness)[:1]


def _with_same(one: Weighed, name: str) -> Weighed:
    """The weighed, where another says the same."""
    rivals = [n for n in one.rivals if n != name]
    return replace(one, equivalents=sorted({*one.equivalents, name}), rivals=rivals)


def with_plainer(
    search: RigSearch, chosen: Model, weighed: Mapping[str, Weighed]
) -> dict[str, Weighed]:
    """The weighed, other dry friction as a rival of a law that is told by a part of itself alone.

    Of Stribeck friction whose peak may be none, or is none beside a soft sign of the speed, no more
    is known than that it is dry.
    """
    told = dict(weighed)
    for effect in chosen.effects:
        name, one = effect.name(), weighed.get(effect.name())
        found = {field: chosen.fit.estimates.get(f"{name}.{field}") for field in effect.fitted()}
        none = [
            e for f, e in found.items() if e and e.low <= effect.neutral.get(f, np.nan) <= e.high
        ]
        numbers = {field: e.value for field, e in found.items() if e}
        if one and is_dry(effect) and (none or (falls(effect) and not falls(effect, numbers))):
            others = {e.name() for e in search.candidates if is_dry(e)} - {name, *one.equivalents}
            told[name] = replace(one, rivals=sorted({*one.rivals, *others}))
    return told


def with_dry(
    search: RigSearch, chosen: Model, weighed: Mapping[str, Weighed]
) -> dict[str, Weighed]:
    """The weighed, dry friction and a constant of logs of one way beside each other.

    Where the other does about as well in its place.  Dry friction has a number more, which tells
    how it turns round: what such logs hold of that is no motion.
    """
    told, models = dict(weighed), search.models
    if not one_way(models.train, models.heldout):
        return told
    dry = _instant(search)
    constants = [e for e in search.candidates if is_constant(e)]
    for effect in (e for e in chosen.effects if e.name() in weighed):
        name, rest = effect.name(), tuple(e for e in chosen.effects if e is not effect)
        for other in dry if is_constant(effect) else constants if is_dry(effect) else ():
            if other in rest or models.related(other, rest):
                continue
            if not is_worse(search, models.fitted((*rest, other), chosen.fit.changes), chosen):
                told[name] = _with_same(told[name], other.name())
    return told
