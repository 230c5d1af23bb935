"""Does a spring that the description does not fit explain what is left, or an effect?

`fit.stiffness` is a number, no effect of the library: a search without it names what comes nearest.
A spring that is at rest elsewhere than at position 0 is one beside a constant force.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spirob.diagnosis.model import Model
from spirob.effects import Effect
from spirob.identify.problem import effort_rms
from spirob.machine.inverse import InverseProblem, Work
from spirob.machine.judging import CONSTANT, Judged, Searched
from spirob.machine.models import RigSearch
from spirob.machine.preparation import Ready, search_of
from spirob.machine.rig import Bounded, RigFile

FITTED = "The logs show {}, which the description does not fit: fitted (`fit: {{stiffness: ...}}`)."
WIDE = 100.0  # times the stiffness that makes all of the effort


def with_spring(done: Searched, again: Callable[[Ready], Searched]) -> Searched:
    """The search with a spring to fit, where that leaves half of the squared error.

    Beside all that was found, or in the place of one effect.

    again  searches a rig of which more is told
    """
    search, chosen = done.search, done.chosen
    if done.is_long or not _may_count(done):
        return done
    beside = _Beside.of(done.ready)
    lesser = [tuple(o for o in chosen.effects if o is not e) for e in chosen.effects]
    for effects in (chosen.effects, *lesser):
        pair = beside.fitted(effects, chosen)
        if pair and search.worth.halves(chosen, pair[1]):
            done.ready.progress("once more, with a spring")
            told = done.ready.told(fit={**done.ready.rig.fit, "stiffness": beside.bounds})
            return again(told).noted(FITTED.format(_words(pair[1])))
    return done


def with_spring_told(judged: Judged) -> Judged:
    """The verdict with what a spring would leave held out, where that is less by what counts."""
    search, chosen = judged.search, judged.chosen
    if judged.verdict.doubts or not _may_count(judged.done):
        return judged
    pair = _Beside.of(judged.done.ready).fitted(chosen.effects, chosen)
    if pair is None:
        return judged
    before, after = (_left(search, model) for model in pair)
    return judged.noted(
        f"With {_words(pair[1])} (`fit: {{stiffness: ...}}`), {after} of the effort would be left "
        f"held out, without it {before}."
    )


def _may_count(done: Searched) -> bool:
    """Whether a spring is no number of the description, and enough is left for it to count."""
    search = done.search
    left = search.worth.possible(done.chosen, 0.0, search.models.promised)
    return left and _is_open(done.ready.rig)


def _is_open(rig: RigFile) -> bool:
    """Whether a description has a position, and says nothing of a spring."""
    return rig.position is not None and "stiffness" not in {*rig.fit, *rig.known}


def _words(sprung: Model) -> str:
    """The spring of a model in words, with its stiffness."""
    found = sprung.fit.estimates["rig.stiffness"]
    return (
        f"a spring of {found.value:.3g} {found.unit} ({found.low:.3g} to {found.high:.3g}), or a "
        "weight over a small angle"
    )


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
        told = sprung.fit.estimates["rig.stiffness"].low > 0.0
        worth = self.without.worth
        if not told or not worth.matters(bare, sprung) or worth.denied(bare, sprung):
            return None
        return bare, sprung

    def _constant(self, effects: Sequence[type[Effect]]) -> list[type[Effect]]:
        """A constant force, where the effects have none and one may act."""
        if any(e.name() in CONSTANT for e in effects):
            return []
        return [e for e in self.without.candidates if e.name() in CONSTANT][:1]


def _stiffness(problem: InverseProblem) -> Bounded:
    """A spring of any size, that begins where it makes a tenth of the effort."""
    scale = problem.table.values[problem.table.position("rig.scale")]
    ratio = float(np.std(problem.measured()) / np.std(problem.signals()["position"]))
    size = abs(float(scale)) * ratio
    return Bounded(nominal=0.1 * size, low=0.0, high=WIDE * size)
