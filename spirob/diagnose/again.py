"""Decide again: the finalists, as they were fitted, foretell a further trial.

Nothing is fitted again.  The trial joins those that decide, so whoever foretells it worse loses
there, block by block, as on any other trial that no fit has seen.
"""

from collections.abc import Mapping
from dataclasses import replace

from spirob.diagnose.ladder import counts, simplest, with_probability
from spirob.diagnose.proposals import Proposal, propose
from spirob.diagnose.rungs import Confirmed, Rung, Search, Settings, label, rung_of, scores_of
from spirob.diagnose.verdict import Verdict
from spirob.effects import Effect
from spirob.identify.problem import Problem
from spirob.identify.residual import Residual


def rivals(search: Search, verdict: Verdict) -> tuple[Confirmed, Confirmed]:
    """The finalist that was found, and the most probable of those that stand beside it."""
    first, last = search.rounds[0], set(search.rungs[-1].effects)
    best = max((c for c in first if set(c.effects) <= last), key=lambda c: c.probability)
    names = {*verdict.rivals, *verdict.equivalents}
    others = [c for c in first if c is not best and _beside(c, names)]
    return best, max(others, key=lambda c: c.probability)


def _beside(found: Confirmed, names: set[str]) -> bool:
    """Whether these names, of single effects or of pairs, hold this candidate."""
    return label(found.effects) in names or {e.name() for e in found.effects} <= names


def proposed(search: Search, verdict: Verdict, problem: Residual) -> list[Proposal]:
    """Experiments that would tell what was found from what else it may be, best first."""
    if not verdict.contested or set(search.rungs[-1].effects) not in _alone(search):
        return []
    one, other = rivals(search, verdict)
    return propose(problem, one.fit.changes, other.fit.changes)


def _alone(search: Search) -> list[set[type[Effect]]]:
    """What the first round found: with more added since, it is not what is in question."""
    return [set(c.effects) for c in search.rounds[0]]


def decided_again(
    search: Search, residuals: Mapping[str, Problem], further: Residual, settings: Settings
) -> tuple[Search, dict[str, Problem]]:
    """The first round judged with further trials among those that decide; and all trials now.

    further  residual on the further trials alone
    """
    decide = residuals["validate"]
    assert isinstance(decide, Residual)
    joined = replace(decide, trials=[*decide.trials, *further.trials])
    known = {**residuals, "validate": joined}
    start = search.rungs[0]
    base = rung_of(start.label, [], start.fit, known)
    tried = with_probability(
        [_foretold(c, known) for c in search.rounds[0]], base, known["train"], settings
    )
    passed = [c for c in tried if counts(c, base, joined, settings)]
    rungs = [base]
    if passed:
        best = simplest(passed, settings)
        effects = list(best.effects)
        rungs.append(Rung(f"+ {label(effects)}", effects, best.fit, best.scores, best.errors))
    return Search(base, rungs, [tried], search.screened, search.vague), known


def _foretold(found: Confirmed, residuals: Mapping[str, Problem]) -> Confirmed:
    scores, missed, errors = scores_of(found.fit, residuals)
    return replace(found, scores=scores, missed=missed, errors=errors)
