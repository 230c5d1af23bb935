"""Does a spring that the description does not fit explain what is left, or what has a name?

`fit.stiffness` is a number, no effect of the library: a search without it names what comes nearest.
A spring that is at rest elsewhere than at position 0 is one beside a constant force.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from spirob.diagnosis.certainty import Ended
from spirob.diagnosis.model import Model
from spirob.diagnosis.verdict import judge, likely
from spirob.effects import Effect
from spirob.identify.problem import effort_rms
from spirob.machine.inverse import InverseProblem, Work
from spirob.machine.judging import Judged
from spirob.machine.models import RigSearch
from spirob.machine.preparation import Ready, search_of
from spirob.machine.rig import Bounded, RigFile

CONSTANT = ("constant_force", "current_offset")
SPRUNG = "No effect is named: the logs show {}, which the description does not fit."
AGAIN = "Fit it (`fit: {stiffness: ...}`) and diagnose again: beside it effects may be named."
WIDE = 100.0  # times the stiffness that makes all of the effort


def with_spring(judged: Judged) -> Judged:
    """The verdict with what a spring would leave held out, where that is less by what counts.

    A name is doubted where a spring in its place leaves half of the squared error held out.
    """
    search, ready, chosen = judged.search, judged.done.ready, judged.chosen
    left = search.worth.possible(chosen, 0.0, search.models.promised)
    if judged.verdict.doubts or not left or not _is_open(ready.rig):
        return judged
    beside = _Beside.of(ready)
    told = likely(judged.verdict.weighed)
    for effect in (e for e in chosen.effects if e.name() in told):
        others = tuple(e for e in chosen.effects if e is not effect)
        pair = beside.fitted(others, chosen)
        if pair and search.worth.refuted(chosen, pair[1]):
            return _doubted(judged, effect, pair[1])
    if pair := beside.fitted(chosen.effects, chosen):
        after, before = _left(search, pair[1]), _left(search, pair[0])
        said = (
            f"With {_spring(pair[1])} (`fit: {{stiffness: ...}}`), {after} of the effort would be"
        )
        return judged.noted(f"{said} left held out, without it {before}.")
    return judged


def _is_open(rig: RigFile) -> bool:
    """Whether a description has a position, and says nothing of a spring."""
    return rig.position is not None and "stiffness" not in {*rig.fit, *rig.known}


def _doubted(judged: Judged, effect: type[Effect], sprung: Model) -> Judged:
    search, found = judged.search, judged.found
    spring = _spring(sprung)
    said = (
        f"Not {effect.title}: {spring}, and a constant force in its place leave "
        f"{_left(search, sprung)} of the effort held out, and it {_left(search, found.chosen)}."
    )
    ended = Ended(search, found, search.models.left(found.chosen))
    verdict = judge(ended, judged.verdict.weighed, (said,))
    verdict = replace(verdict, sentence=SPRUNG.format(spring), next_experiment=AGAIN)
    return replace(judged, verdict=verdict, law=None)


def _spring(sprung: Model) -> str:
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
    """Searches over the logs of a rig as described, and with a spring to fit."""

    without: RigSearch
    spring: RigSearch

    @classmethod
    def of(cls, ready: Ready) -> "_Beside":
        """Searches of their own: what is fitted here says nothing of how long another took."""
        ready = replace(ready, work=Work(), progress=lambda text: None)
        without, _ = search_of(ready)
        fit = {**ready.rig.fit, "stiffness": _stiffness(without.models.train)}
        return cls(without, search_of(ready.told(fit=fit))[0])

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
