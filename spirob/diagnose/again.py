"""Decide again, with trials played where two explanations differ most.

The further trials lie outside of what was fitted, where no model is complete: numbers that hardly
showed before weigh there.  So one of them, with the one motor in the lead, joins those that are
fitted, and the contestants are fitted again; the other, with the other motor, joins those that
decide.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from spirob.diagnose.confirm import finished
from spirob.diagnose.contest import Contestant, contestants
from spirob.diagnose.proposals import Proposal, propose
from spirob.diagnose.rungs import Confirmed, Rung, Search, Settings, label, rung_of, scores_of
from spirob.diagnose.verdict import Verdict
from spirob.diagnose.weighing import counts, simplest, with_probability
from spirob.effects import Effect
from spirob.identify.fit import STEPS, Fit, fit
from spirob.identify.measurement import Measurement
from spirob.identify.near import near
from spirob.identify.problem import Problem
from spirob.identify.residual import Residual


def proposed(search: Search, verdict: Verdict, problem: Residual) -> list[Proposal]:
    """Experiments that would tell what was found from what else it may be, best first."""
    if not verdict.contested or set(search.rungs[-1].effects) not in _alone(search):
        return []
    one, other = contestants(search, verdict)[:2]
    return propose(problem, one.fit.changes, other.fit.changes)


def _alone(search: Search) -> list[set[type[Effect]]]:
    """What the first round found: with more added since, it is not what is in question."""
    return [set(c.effects) for c in search.rounds[0]]


def joined(
    residuals: Mapping[str, Problem], further: Mapping[str, Sequence[Measurement]]
) -> dict[str, Problem]:
    """The same with further trials, by role."""
    found = dict(residuals)
    for role, trials in further.items():
        problem = residuals[role]
        assert isinstance(problem, Residual)
        found[role] = replace(problem, trials=[*problem.trials, *trials])
    return found


def decided_again(
    models: Sequence[Contestant], residuals: Mapping[str, Problem], settings: Settings
) -> Search:
    """A contest fitted again to trials that hold the further ones, as a search of one round."""
    start, *others = models
    train = near(residuals["train"], start.changes)
    close = {**residuals, "train": train}
    base = rung_of("fitted parameters", [], _fitted(start, train, settings), close)
    tried = []
    for one in others:
        found = _fitted(one, train, settings)
        scores, missed, errors = scores_of(found, close)
        tried.append(Confirmed(one.effects, one.gain, found, missed, errors, scores))
    tried = with_probability(tried, base, train, settings)
    rungs = [base]
    if passed := [c for c in tried if counts(c, base, residuals["validate"], settings)]:
        won = finished(simplest(passed, settings), residuals, settings)
        effects = list(won.effects)
        rungs.append(Rung(f"+ {label(effects)}", effects, won.fit, won.scores, won.errors))
    return Search(base, rungs, [tried])


def _fitted(one: Contestant, train: Problem, settings: Settings) -> Fit:
    return fit(
        train,
        one.names,
        one.changes,
        settings.scale,
        settings.iterations,
        steps=STEPS[-1:],
        exact=False,
    )
