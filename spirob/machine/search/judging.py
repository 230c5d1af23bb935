"""What stands of a search: the verdict, and where it asks for one a law.

A name stands for a cause, a law for a shape; where both tell the same, the name is preferred.  But
where something is left beside the names that follows from the motion, or is far more than noise, a
law of what they are meant
to explain, composed beside the fitted numbers alone, may be plainer than the names and what is
composed beside them, and predict as well.  The names then only imitate it (`outdone`).
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import partial

from spirob.diagnosis.certainty import Ended
from spirob.diagnosis.conclusion import Weighed, concluded, likely, weigh
from spirob.diagnosis.criteria import Worth
from spirob.diagnosis.model import Found, Model, is_dry
from spirob.diagnosis.verdict import TWICE, Verdict, judge
from spirob.identify.identifiability import Identifiability
from spirob.machine.composed import Composed, composed
from spirob.machine.composed.draft import Draft, is_bent
from spirob.machine.inverse.shapes import shaping
from spirob.machine.search.delays import only_smoothing
from spirob.machine.search.dry_friction import with_dry, with_instant, with_plainer
from spirob.machine.search.foretold import misleading, swallowing
from spirob.machine.search.leftovers import RigCeiling, noisy, structured, unexplained
from spirob.machine.search.models import RigSearch
from spirob.machine.search.odd_logs import FAMILIAR, another_unit, poorest, strangers
from spirob.machine.search.plausibility import doubts, only_of_logs
from spirob.machine.search.preparation import Ready

ALL_FIT = "A law composed without any name fits all logs, which no model of the library does."
DENIED = (
    "Not named: {}. The effort would follow from the motion by it, but run forward by the effort "
    "the model moves far worse with it than without."
)
SWALLOWED = (
    "Not named: {}. About the measured effort it explains much; by the motion alone the effort is "
    "foretold no better with it than without."
)
TERM = 2  # numbers, an amplitude and what shapes it: a law is plainer by a term at least
OUTDONE = (
    "A law composed without any name is plainer and leaves less than half the squared error, or "
    "leaves nothing that counts: what was nearest only imitates it."
)


@dataclass(frozen=True)
class Searched:
    """What a search over a rig's logs ended with.

    gate   what they can say about its numbers
    plain  the search without numbers of single logs, where these were found out
    """

    ready: Ready
    search: RigSearch
    gate: Identifiability
    found: Found
    plain: "Searched | None" = None

    @property
    def chosen(self) -> Model:
        return self.found.chosen

    def noted(self, said: str) -> "Searched":
        """The same with a further note, each once."""
        said_once = list(dict.fromkeys([*self.ready.said, said]))
        return replace(self, ready=replace(self.ready, said=said_once))

    @property
    def is_long(self) -> bool:
        """Whether it took so much that another search, begun otherwise, would take too long."""
        return self.search.models.is_long


@dataclass(frozen=True)
class Judged:
    """A search, what stands of it, and the verdict.

    rest  what follows from the motion yet;  law  that takes some of it, where one is composed
    """

    done: Searched
    found: Found
    verdict: Verdict
    rest: RigCeiling
    law: Composed | None = None

    @property
    def search(self) -> RigSearch:
        return self.done.search

    @property
    def chosen(self) -> Model:
        return self.found.chosen

    @property
    def explained(self) -> Model:
        """The model with all that is told: the law, where there is one."""
        return self.law.model if self.law else self.chosen

    def noted(self, said: str) -> "Judged":
        """The same with a further note."""
        return replace(self, done=self.done.noted(said))


def judged_of(done: Searched) -> Judged:
    """The verdict on a search, and the law that it asks for."""
    search = done.search
    ended, weighed = confirmed(*concluded(search, done.found, lambda m: contradicted(search, m)))
    ended, weighed, denied = foretelling(ended, weighed)
    done = done.noted(denied) if denied else done
    weighed, said = with_instant(search, ended.found.chosen, weighed)
    weighed = with_plainer(search, ended.found.chosen, weighed)
    weighed = with_dry(search, ended.found.chosen, weighed)
    rest = search.models.ceiling(ended.found.chosen)
    causes = doubts(search, ended.found, rest, believed=bool(likely(weighed)))
    verdict = judge(ended, weighed, causes)
    judged = Judged(done, ended.found, verdict, rest)
    if verdict.doubts:
        return _in_all_logs(judged)
    if verdict.kind == "unknown":
        return _taught(judged, ended, composed(search, ended.found, ended.found.rungs[0]))
    judged = _beside_laws(judged)
    told = judged.verdict.kind in ("named", "undecided")
    return judged.noted(said) if said and told else judged


def _taught(judged: Judged, ended: Ended, law: Composed | None) -> Judged:
    """With a law of what is left; in doubt instead, where it fits all logs but some strangers."""
    models = judged.search.models
    residuals = (law.model.fit.residual, law.model.heldout) if law else ()
    odd = strangers((models.train, models.heldout), residuals) if residuals else None
    if odd is None:
        return replace(judged, law=law)
    return replace(judged, verdict=judge(ended, judged.verdict.weighed, [odd.said]))


def contradicted(search: RigSearch, model: Model) -> set[str]:
    """Names of a model's effects that its curves or its delay deny.

    Dry friction of visibly another shape; a lag that a delay of the other sign undoes.
    """
    period = max(r.period for r in search.models.train.recordings)
    names = only_smoothing(model, search.models.train.rig, period)
    return names | {e.name() for e in model.effects if is_dry(e) and is_bent(search, model)}


def _in_all_logs(judged: Judged) -> Judged:
    """Without the doubt about a log where a law is composed with which all of them fit."""
    search, found = judged.search, judged.found
    problems = search.models.train, search.models.heldout
    if another_unit(problems) or not only_of_logs(search, found, judged.verdict):
        return judged
    law = composed(search, found, found.rungs[0])
    if law is None or not search.worth.halves(found.rungs[0], law.model):
        return judged
    fits = poorest(problems, (law.model.fit.residual, law.model.heldout)) >= FAMILIAR
    return _by_law(judged, law, ALL_FIT) if fits else judged


def _beside_laws(judged: Judged) -> Judged:
    """With the law of what a name leaves; without the name where a law alone outdoes both.

    Where much is left that does not follow from the motion, only the latter is asked.
    """
    search, found, verdict = judged.search, judged.found, judged.verdict
    models, chosen = search.models, found.chosen
    follows = structured(models, chosen, judged.rest)
    if verdict.kind not in ("named", "undecided") or not (follows or noisy(models, chosen)):
        return judged
    beside = composed(search, found, chosen)
    alone = composed(search, found, found.rungs[0], partial(may_outdo, chosen))
    richer = beside.model if beside else chosen
    whole = unexplained(models, richer) and explains_all(search.worth, alone)
    if alone is None or not (whole or outdone(search.worth, chosen, beside, alone)):
        return replace(judged, law=beside) if follows else judged
    return _by_law(judged, alone, OUTDONE)


def _by_law(judged: Judged, law: Composed, said: str) -> Judged:
    """No name, and a law that does better than any."""
    search = judged.search
    ended, unnamed = _nameless(search, judged.found, judged.verdict.weighed)
    verdict = judge(ended, unnamed, lacking=True)
    verdict = replace(verdict, explanation=f"{verdict.explanation} {said}")
    bare = ended.found
    return Judged(judged.done, bare, verdict, search.models.ceiling(bare.chosen), law)


def confirmed(ended: Ended, weighed: Mapping[str, Weighed]) -> tuple[Ended, Mapping[str, Weighed]]:
    """What stands of a search, without its names where the held-out logs deny them as a whole.

    What is likely may lower the held-out error only beside what is not.
    """
    bare, chosen = ended.found.rungs[0], ended.found.chosen
    if not likely(weighed) or not ended.search.worth.denied(bare, chosen):
        return ended, weighed
    return _nameless(ended.search, ended.found, weighed)


def foretelling(
    ended: Ended, weighed: Mapping[str, Weighed]
) -> tuple[Ended, Mapping[str, Weighed], str]:
    """What stands of a search, without names that mislead where more is foretold; what is said.

    Those beside them are weighed again.
    """
    search, found, told = ended.search, ended.found, likely(weighed)
    wrong = {
        DENIED: misleading(search, found.chosen, told),
        SWALLOWED: swallowing(search, found.chosen, told),
    }
    names = [name for off in wrong.values() for name in off]
    if not names:
        return ended, weighed, ""
    said = " ".join(why.format(_titles(found.chosen, off)) for why, off in wrong.items() if off)
    off = {n: weighed[n].denied for n in names}
    others = [e.name() for e in found.chosen.effects if e.name() not in names]
    kept = search.narrowed(found, others)
    without = Ended(search, kept, search.models.left(kept.chosen))
    again = weigh(without, lambda m: contradicted(search, m))
    return *confirmed(without, {**off, **again}), said


def _titles(model: Model, names: Collection[str]) -> str:
    return " and ".join(e.title for e in model.effects if e.name() in names)


def _nameless(
    search: RigSearch, found: Found, weighed: Mapping[str, Weighed]
) -> tuple[Ended, dict[str, Weighed]]:
    """A search without any of its names; the weighed are told as unlikely."""
    unnamed = {n: one.denied for n, one in weighed.items()}
    bare = search.narrowed(found, [])
    return Ended(search, bare, search.models.left(bare.chosen)), unnamed


def outdone(worth: Worth, named: Model, beside: Composed | None, alone: Composed | None) -> bool:
    """Whether the law `alone` halves what `named` leaves, and is plainer than it and its law.

    named   the model with the names;  beside  the law of what it leaves
    alone   the law of what the fitted numbers leave

    A name counts as a term: a law of as many terms as it and its law together holds one in its
    place.  No plainer the law may be where beside theirs no number of the names is told, or where
    it halves what they leave together.  Where they are better by a size that counts, they are not
    outdone.
    """
    richer = beside.model if beside else named
    if alone is None or not worth.halves(named, alone.model):
        return False
    idle = numbers(richer, named.names) == 0 or worth.halves(richer, alone.model)
    fewer = idle or alone.terms < len(named.names) + (beside.terms if beside else 0)
    plain = numbers(alone.model) + (0 if idle else TERM) <= numbers(richer)
    return fewer and plain and not worth.matters(alone.model, richer)


def explains_all(worth: Worth, alone: Composed | None) -> bool:
    """Whether a law leaves nothing that counts, of fitted logs and of held-out ones."""
    if alone is None:
        return False
    left = max(alone.model.mean_square, alone.model.heldout_square)
    return left < (TWICE * worth.least) ** 2


def may_outdo(named: Model, draft: Draft) -> bool:
    """Whether a draft leaves little enough to be such a law."""
    return draft.mean_square < named.mean_square


def numbers(model: Model, names: Collection[str] | None = None) -> int:
    """Numbers of its effects, or of the named ones, that a model tells.

    Told is an amplitude whose interval holds no neutral value, and what shapes such a one.  One
    more is counted for each effect that is told and remembers.
    """
    count = 0
    for effect in model.effects:
        if names is not None and effect.name() not in names:
            continue
        full = {f: f"{effect.name()}.{f}" for f in effect.fitted()}
        found = {f: model.fit.estimates[n] for f, n in full.items() if n in model.fit.estimates}
        told = [
            f
            for f, zero in effect.neutral.items()
            if f in found and not found[f].low <= zero <= found[f].high
        ]
        shapes = {shape for field in told for shape in shaping(effect, field)}  # type: ignore[arg-type] # a class is hashable
        count += len(told) + len(shapes & set(found)) + bool(told and effect.state)
    return count
