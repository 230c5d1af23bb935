"""Decide again, with trials played where two explanations differ most.

The further trials lie outside of what was fitted, where no model is complete: numbers that hardly
showed before weigh there.  So one of them, with the one motor in the lead, joins those that are
fitted, and the contestants are fitted again; the other, with the other motor, joins those that
decide.
"""

from collections.abc import Mapping
from dataclasses import replace

from spirob.diagnose.confirm import refitted
from spirob.diagnose.proposals import Proposal, propose
from spirob.diagnose.rungs import Confirmed, Rung, Search, Settings, label, rung_of, scores_of
from spirob.diagnose.verdict import Verdict
from spirob.diagnose.weighing import counts, simplest, with_probability
from spirob.effects import Effect
from spirob.identify.fit import STEPS, Fit, fit
from spirob.identify.near import near
from spirob.identify.problem import Problem
from spirob.identify.residual import Residual


def contestants(search: Search, verdict: Verdict) -> list[Confirmed]:
    """The finalist that was found, then those that stand beside it, the most probable first."""
    first, last = search.rounds[0], set(search.rungs[-1].effects)
    best = max((c for c in first if set(c.effects) <= last), key=lambda c: c.probability)
    names = {*verdict.rivals, *verdict.equivalents}
    others = [c for c in first if c is not best and _beside(c, names)]
    return [best, *sorted(others, key=lambda c: -c.probability)]


def _beside(found: Confirmed, names: set[str]) -> bool:
    """Whether these names, of single effects or of pairs, hold this candidate."""
    return label(found.effects) in names or {e.name() for e in found.effects} <= names


def proposed(search: Search, verdict: Verdict, problem: Residual) -> list[Proposal]:
    """Experiments that would tell what was found from what else it may be, best first."""
    if not verdict.contested or set(search.rungs[-1].effects) not in _alone(search):
        return []
    one, other = contestants(search, verdict)[:2]
    return propose(problem, one.fit.changes, other.fit.changes)


def _alone(search: Search) -> list[set[type[Effect]]]:
    """What the first round found: with more added since, it is not what is in question."""
    return [set(c.effects) for c in search.rounds[0]]


def decided_again(
    search: Search,
    residuals: Mapping[str, Problem],
    further: Mapping[str, Residual],
    verdict: Verdict,
    settings: Settings,
) -> tuple[Search, dict[str, Problem]]:
    """The first round between its contestants with further trials; and all trials now.

    further  residuals on the further trials alone, those to fit ("train") and those that decide
             ("validate").  Who was no contestant stays behind them
    """
    joined = {role: _joined(residuals[role], more) for role, more in further.items()}
    known = {**residuals, **joined}
    start, best = search.rungs[0], contestants(search, verdict)
    train = near(known["train"], start.fit.changes)
    close = {**known, "train": train}
    base = rung_of(start.label, [], _again(start.fit, train, settings), close)
    tried = [refitted(c, _again(c.fit, train, settings), close) for c in best]
    tried = with_probability(tried, base, train, settings)
    passed = [c for c in tried if counts(c, base, known["validate"], settings)]
    rungs = [base]
    if passed:
        won = simplest(passed, settings)
        effects = list(won.effects)
        rungs.append(Rung(f"+ {label(effects)}", effects, won.fit, won.scores, won.errors))
    unfitted = {**known, "train": residuals["train"]}
    behind = [_foretold(c, unfitted) for c in search.rounds[0] if c not in best]
    return Search(base, rungs, [[*tried, *behind]], search.screened, search.vague), known


def _joined(problem: Problem, further: Residual) -> Problem:
    assert isinstance(problem, Residual)
    return replace(problem, trials=[*problem.trials, *further.trials])


def _again(found: Fit, train: Problem, settings: Settings) -> Fit:
    return fit(
        train,
        list(found.estimates),
        found.changes,
        settings.scale,
        settings.patience,
        steps=STEPS[-1:],
        exact=False,
    )


def _foretold(found: Confirmed, residuals: Mapping[str, Problem]) -> Confirmed:
    """Another, as it was fitted: it had lost before."""
    scores, missed, errors = scores_of(found.fit, residuals)
    return replace(found, scores=scores, missed=missed, errors=errors, probability=0.0)
