"""Names that do not hold when the motion, or the effort, is foretold.

From the motion to the effort a law may take what is none of it.  One that swings by itself is a
filter there, and under an effort of one line, a sine, a filter that smooths the motion takes what
friction or noise leaves.  Where the effort has one size, as under a relay, dry friction is the
effort itself up to a factor, and so is a constant where it has one sign, too: they take whatever
the speed does besides.  Forward
the measured effort has to move the axis as it moved; with a law that is none it does so far worse.
Of other laws that is not asked: run forward, a good law of an axis that is hardly damped drifts
away with the noise of its effort, and a bad one that resists too much stays where it is.

A law between an effort and its torque is fitted about the measured effort, whose own peaks a
saturation or a dead band may swallow.  Where it does, it has to foretell the effort by the motion
alone better than what is found without such laws.
"""

from collections.abc import Collection

import numpy as np

from spirob.diagnosis.criteria import HALVED
from spirob.diagnosis.model import Model, is_constant, is_dry
from spirob.effects import Effect
from spirob.machine.forward import Forward
from spirob.machine.forward.axis import PORTS
from spirob.machine.inverse.equations import BEFORE, LAST
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.search.models import Models, RigSearch

SCATTER = 0.05  # of the squared efforts: what is no size with a sign, where they have one size


def misleading(search: RigSearch, chosen: Model, names: Collection[str]) -> list[str]:
    """Those of the names with which motion is foretold far worse than without.

    Far worse: without it half of the squared error is left, of the speed within half a second, and
    less than of an axis that stands still: of two that both run away neither foretells anything.
    Held-out logs are asked and fitted ones: either may hold one speed, which every balance keeps.
    """
    named = [e for e in chosen.effects if e.name() in names]
    level = [e for e in named if is_dry(e) or is_constant(e)]
    relay = bool(level) and _of_one_size(search.models.train)
    asked = [e for e in named if _swings(e) or (relay and e in level)]
    if not asked:
        return []
    runs = [Forward(problem) for problem in (search.models.train, search.models.heldout)]
    lesser = {e.name(): search.without(chosen, e) for e in asked}
    return [n for n, model in lesser.items() if any(_is_worse(r, model, chosen) for r in runs)]


def passes(effect: type[Effect]) -> bool:
    """Whether a law lies between the effort and the torque that it makes."""
    return effect.port in (*BEFORE, LAST)


def swallows(models: Models, model: Model) -> bool:
    """Whether the effort is foretold worse than it is told about the measured one, by what counts.

    Only of laws between the effort and its torque; of fitted logs or of held-out ones.
    """
    if not any(map(passes, model.effects)):
        return False
    changes, least = model.fit.changes, models.least**2
    return any(
        _missed(p, model) > float(np.mean(p(changes) ** 2)) + least
        for p in (models.train, models.heldout)
    )


def foretells(models: Models, named: Model, without: Model) -> bool:
    """Whether the effort is foretold better with laws between it and its torque than without.

    Both where they were fitted and held out.
    """
    problems = models.train, models.heldout
    return all(_missed(p, named) < _missed(p, without) for p in problems)


def swallowing(search: RigSearch, chosen: Model, names: Collection[str]) -> list[str]:
    """Those of the names between effort and torque with which the effort is foretold no better."""
    asked = {e.name(): e for e in chosen.effects if passes(e) and e.name() in names}
    lesser = {name: search.without(chosen, e) for name, e in asked.items()}
    return [n for n, model in lesser.items() if not foretells(search.models, chosen, model)]


def _missed(problem: InverseProblem, model: Model) -> float:
    return float(np.mean(problem.foretold(model.fit.changes) ** 2))


def _swings(effect: type[Effect]) -> bool:
    """Whether it may begin with any state, and acts on the torque that moves the axis."""
    return bool(effect.free) and effect.port in PORTS


def _of_one_size(problem: InverseProblem) -> bool:
    """Whether the efforts that are compared are hardly more than a size with a sign."""
    efforts = np.concatenate([p.raw[p.use] for r in problem.recordings for p in r.pieces])
    return float(np.mean(np.abs(efforts)) ** 2) >= (1.0 - SCATTER) * float(np.mean(efforts**2))


def _is_worse(run: Forward, without: Model, chosen: Model) -> bool:
    models = without.fit.changes, chosen.fit.changes
    if any(run.absent(changes) for changes in models):
        return False
    before, after = (run.missed(changes) for changes in models)
    moved = float(np.mean(run.problem.asked.motion.v**2))
    return before < min(HALVED * after, moved)
