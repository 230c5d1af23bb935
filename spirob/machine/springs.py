"""Does a spring that the description does not fit explain what is left, or an effect?

`fit.stiffness` is a number, no effect of the library: a search without it names what comes nearest.
A spring that is at rest elsewhere than at position 0 is one beside a constant force.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spirob.diagnosis.conclusion import likely
from spirob.diagnosis.model import Model, is_constant
from spirob.effects import Effect
from spirob.identify.problem import effort_rms, rms
from spirob.machine.inverse import InverseProblem, Work
from spirob.machine.judging import Judged
from spirob.machine.models import RigSearch
from spirob.machine.preparation import Ready, search_of
from spirob.machine.rig import Bounded, RigFile

FITTED = "It is fitted, as by `fit: {stiffness: ...}`."
WEIGHT = "tip_payload"
NO_WEIGHT = "beside a spring that is not described a weight makes a spring that grows with the way"
WIDE = 100.0  # times the stiffness that makes all of the effort


@dataclass(frozen=True)
class Spring:
    """A spring that explains more than the model that stands.

    said  what it would leave;  instead  whether in the place of a name
    """

    bounds: Bounded
    model: Model
    said: str
    instead: bool


def with_spring(judged: Judged, again: Callable[[Ready], Judged]) -> Judged:
    """The verdict beside a spring, where no name stands without it.

    Where none stands beside it either, and a law without it explains more, it is told alone, with
    what it would leave.

    again  the verdict of a search
    """
    spring = None if judged.verdict.doubts else _spring_of(judged)
    if spring is None:
        return judged
    if likely(judged.verdict.weighed) and not spring.instead:
        return judged.noted(spring.said)
    judged.done.ready.progress("once more, with a spring")
    sprung = again(replace(_sprung(judged.done.ready, spring.bounds), work=Work()))
    by_law = judged.search.worth.matters(sprung.explained, judged.explained)
    if sprung.verdict.kind == "unknown" and by_law and not spring.instead:
        return judged.noted(spring.said)
    return sprung.noted(f"{spring.said} {FITTED}")


def _sprung(ready: Ready, spring: Bounded) -> Ready:
    """The rig with a spring to fit, and without a weight.

    Of opposite signs the two are straight nowhere: they make what a spring does that grows with the
    way.
    """
    possible = [e for e in ready.possible if e.name() != WEIGHT]
    told = ready.told(fit={**ready.rig.fit, "stiffness": spring})
    return replace(told, possible=possible, excluded=ready.excluded | {WEIGHT: NO_WEIGHT})


def _spring_of(judged: Judged) -> Spring | None:
    """A spring in the place of a name, of whose squared error it leaves half held out, or beside
    what is likely, where it leaves less than what was found by what counts."""
    search, ready, chosen = judged.search, judged.done.ready, judged.chosen
    left = search.worth.possible(chosen, 0.0, search.models.promised)
    if not left or not _is_open(ready.rig):
        return None
    beside = _Beside.of(ready)
    told = likely(judged.verdict.weighed)
    for effect in (e for e in chosen.effects if e.name() in told):
        others = tuple(e for e in chosen.effects if e is not effect)
        pair = beside.fitted(others, chosen)
        if pair and search.worth.refuted(chosen, pair[1]):
            said = (
                f"Not {effect.title}: {_words(pair[1])}, and a constant force in its place leave "
                f"{_left(search, pair[1])} of the effort held out, and it {_left(search, chosen)}."
            )
            return Spring(beside.bounds, pair[1], said, instead=True)
    pair = beside.fitted(tuple(e for e in chosen.effects if e.name() in told), chosen)
    if pair and search.worth.matters(chosen, pair[1]):
        before, after = _left(search, chosen), _left(search, pair[1])
        said = (
            f"With {_words(pair[1])} (`fit: {{stiffness: ...}}`), {after} of the effort would be "
            f"left held out, without it {before}."
        )
        return Spring(beside.bounds, pair[1], said, instead=False)
    return None


def _is_open(rig: RigFile) -> bool:
    """Whether a description has a position, and says nothing of a spring."""
    return rig.position is not None and "stiffness" not in {*rig.fit, *rig.known}


def _words(sprung: Model) -> str:
    """The spring of a model in words, with its stiffness."""
    found = sprung.fit.estimates["rig.stiffness"]
    kind = "a weight over a small angle" if found.value > 0.0 else "a weight held upright"
    size = f"{found.value:.3g} {found.unit} ({found.low:.3g} to {found.high:.3g})"
    return f"a spring of {size}, or {kind}"


def _left(search: RigSearch, model: Model) -> str:
    return f"{np.sqrt(model.heldout_square) / effort_rms(search.models.heldout):.1%}"


@dataclass(frozen=True)
class _Beside:
    """Searches over the logs of a rig as described, and with a spring to fit within `bounds`."""

    without: RigSearch
    spring: RigSearch
    bounds: Bounded

    @classmethod
    def of(cls, ready: Ready) -> "_Beside":
        """Searches of their own: what is fitted here says nothing of how long another took."""
        ready = replace(ready, work=Work(), progress=lambda text: None)
        without, _ = search_of(ready)
        bounds = _stiffness(without.models.train)
        spring, _ = search_of(ready.told(fit={**ready.rig.fit, "stiffness": bounds}))
        return cls(without, spring, bounds)

    def fitted(
        self, effects: tuple[type[Effect], ...], chosen: Model
    ) -> tuple[Model, Model] | None:
        """The model of a set beside a constant force, and with a spring; None where none is told.

        chosen  where its numbers begin
        """
        effects = (*effects, *self._constant(effects))
        models = [s.models.fitted(effects, chosen.fit.changes) for s in (self.without, self.spring)]
        bare, sprung = models
        found = sprung.fit.estimates["rig.stiffness"]
        told = found.low > 0.0 or found.high < 0.0
        worth = self.without.worth
        if not told or not worth.matters(bare, sprung) or worth.denied(bare, sprung):
            return None
        return bare, sprung

    def _constant(self, effects: Sequence[type[Effect]]) -> list[type[Effect]]:
        """A constant force, where the effects have none and one may act."""
        if any(map(is_constant, effects)):
            return []
        return [e for e in self.without.candidates if is_constant(e)][:1]


def _stiffness(problem: InverseProblem) -> Bounded:
    """A spring of any size and sign, that begins where it makes a tenth of the effort."""
    scale = problem.table.values[problem.table.position("rig.scale")]
    ratio = rms(problem.measured()) / float(np.std(problem.signals()["position"]))
    size = abs(float(scale)) * ratio
    return Bounded(nominal=0.1 * size, low=-WIDE * size, high=WIDE * size)
