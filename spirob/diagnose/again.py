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
from spirob.identify.problem import Problem
from spirob.identify.residual import Residual


def rivals(search: Search, verdict: Verdict) -> tuple[Confirmed, Confirmed]:
    """The two finalists between which an undecided verdict most needs to choose."""
    first = search.rounds[0]
    named = set(search.rungs[-1].effects)
    best = next(c for c in first if set(c.effects) == named)
    names = set(verdict.rivals)
    others = [c for c in first if c is not best and {e.name() for e in c.effects} <= names]
    return best, max(others, key=lambda c: c.probability)


def proposed(search: Search, verdict: Verdict, problem: Residual) -> list[Proposal]:
    """Experiments that would tell the rivals of an undecided verdict apart, best first."""
    if verdict.kind != "undecided":
        return []
    one, other = rivals(search, verdict)
    return propose(problem, one.fit.changes, other.fit.changes)


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
