"""Who stands beside what was found, and the decision between them by further trials.

Decide again, with trials played where two explanations differ most.

The further trials lie outside of what was fitted, where no model is complete: numbers that hardly
showed before weigh there, other currents flow, and things happen that no effect in question is the
cause of.  So they only say *which* of the contestants it is.  One of them, with the one motor in
the lead, joins those that are fitted, and the contestants are fitted again; the other, with the
other motor, joins those on which they are compared.  How much is explained, and whether that is
enough, is judged where the effect was found.  A further trial that no contestant explains says
nothing of them and is set aside; so is one that leaves two beside each other which said the same
where they were found: it was to say which, and one name for both is the better answer.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spirob.diagnosis.confirm import finished
from spirob.diagnosis.evidence import complete
from spirob.diagnosis.proposals import Proposal, propose
from spirob.diagnosis.rungs import Confirmed, Ladder, Rung, Settings, label, rung_of, scores_of
from spirob.diagnosis.verdict import Verdict, judge
from spirob.diagnosis.weighing import simplest, with_probability
from spirob.effects import Effect, find_effects
from spirob.identify.fit import STEPS, Fit, fit
from spirob.identify.measurement import Measurement
from spirob.identify.problem import Problem
from spirob.identify.residual import Residual, near


@dataclass(frozen=True)
class Contestant:
    """A fitted model that stands beside others.

    effects  none for the model without any;  names  of what is fitted;  changes  where that ended
    gain     what the screening promised
    """

    effects: tuple[type[Effect], ...]
    names: tuple[str, ...]
    changes: Mapping[str, float]
    gain: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for another process to go on from."""
        plain = {"names": list(self.names), "changes": dict(self.changes), "gain": self.gain}
        return {"effects": [e.name() for e in self.effects], **plain}

    @staticmethod
    def from_dict(plain: Mapping[str, Any]) -> "Contestant":
        """Back from plain data."""
        effects = tuple(find_effects(plain["effects"]))
        return Contestant(effects, tuple(plain["names"]), dict(plain["changes"]), plain["gain"])


def contest(search: Ladder, verdict: Verdict) -> list[Contestant]:
    """The model without any effect, then those that stand beside each other."""
    start = search.rungs[0].fit
    found = [Contestant((), tuple(start.estimates), start.changes)]
    for c in contestants(search, verdict):
        found.append(Contestant(c.effects, tuple(c.fit.estimates), c.fit.changes, c.gain))
    return found


def in_question(search: Ladder, verdict: Verdict) -> list[Contestant]:
    """The model without any effect, the one with what was found, and those beside it, if any."""
    last = search.rungs[-1]
    if verdict.contested and set(last.effects) in alone(search):
        return contest(search, verdict)
    return [
        Contestant(tuple(r.effects), tuple(r.fit.estimates), r.fit.changes)
        for r in (search.rungs[0], last)
    ]


def alone(search: Ladder) -> list[set[type[Effect]]]:
    """What the first round found: with more added since, it is not what is in question."""
    return [set(c.effects) for c in search.rounds[0]]


def contestants(search: Ladder, verdict: Verdict) -> list[Confirmed]:
    """The finalist that was found, then those that stand beside it, the most probable first.

    Only where the first round found it `alone`.
    """
    first, last = search.rounds[0], set(search.rungs[-1].effects)
    best = next(c for c in first if set(c.effects) == last)
    names = {*verdict.rivals, *verdict.equivalents}
    others = [c for c in first if c is not best and _beside(c, names)]
    return [best, *sorted(others, key=lambda c: -c.probability)]


def _beside(found: Confirmed, names: set[str]) -> bool:
    """Whether these names, of single effects or of pairs, hold this candidate."""
    return label(found.effects) in names or {e.name() for e in found.effects} <= names


TELLING = 0.5  # of a further trial's squared error above the floor that one contestant explains


def proposed(
    search: Ladder, verdict: Verdict, problem: Residual, settings: Settings
) -> list[Proposal]:
    """Experiments that would tell what was found from what else it may be, best first.

    None where the two differ by less than counts as an effect on all of them: two names of one law.
    """
    if not verdict.contested or set(search.rungs[-1].effects) not in alone(search):
        return []
    one, other = contestants(search, verdict)[:2]
    every = propose(problem, one.fit.changes, other.fit.changes)
    return [p for p in every if p.share > settings.floor]


def joined(
    residuals: Mapping[str, Residual], further: Mapping[str, Sequence[Measurement]]
) -> dict[str, Residual]:
    """The same with further trials, by role."""
    found = dict(residuals)
    for role, trials in further.items():
        found[role] = replace(found[role], trials=[*found[role].trials, *trials])
    return found


def further_of(own: Mapping[str, Residual], known: Mapping[str, Residual]) -> Residual:
    """Of the trials that `joined` put to these, those on which models are compared."""
    played = known["validate"]
    return replace(played, trials=played.trials[len(own["validate"].trials) :])


def decided_again(
    models: Sequence[Contestant],
    own: Mapping[str, Residual],
    known: Mapping[str, Residual],
    settings: Settings,
    before: str = "undecided",
) -> Ladder | None:
    """A contest settled by further trials, as a search of one round to be judged on the first ones.

    own     the trials in which the effect was found;  known  the same with the further ones
    before  the kind of verdict that stands on `own`: named, if they say the same there
    What each explains is taken from `own`, how it misses and how often it wins from `known`: two
    say the same only where they do so in the further trials, too.
    None where the further trials show what no contestant explains, or do not tell which of those
    that said the same it is.
    """
    wide_base, wide = compared(models, known, settings)
    if not _explained(wide_base.fit, [c.fit for c in wide], further_of(own, known), settings):
        return None
    winner = simplest(wide, known["train"], settings).effects
    found = settled(compared(models, own, settings), wide, winner, own, settings)
    open_still = before == "named" and judge(found, own, settings).kind == "undecided"
    return None if open_still else found


def settled(
    near_by: tuple[Rung, Sequence[Confirmed]],
    contest: Sequence[Confirmed],
    winner: tuple[type[Effect], ...],
    own: Mapping[str, Residual],
    settings: Settings,
) -> Ladder:
    """A settled contest as a search of one round, to be judged on the trials that began it.

    near_by  the contestants as `compared` on these trials, `own`, and the rung below them
    contest  the same where it was settled: how they miss and how often each wins
    """
    base, found = near_by[0], {c.effects: c for c in near_by[1]}
    won = finished(found[winner], own, settings)
    rung = Rung(f"+ {label(winner)}", list(winner), won.fit, won.scores, won.errors)
    tried = [replace(found[c.effects], missed=c.missed, probability=c.probability) for c in contest]
    return Ladder(base, [base, rung], [tried])


def compared(
    models: Sequence[Contestant], residuals: Mapping[str, Problem], settings: Settings
) -> tuple[Rung, list[Confirmed]]:
    """All fitted again to these trials, the model without an effect first; how often each wins."""
    start, *others = models
    train = residuals["train"]
    base = rung_of("fitted parameters", [], _fitted(start, train, settings), residuals)
    tried = []
    for one in others:
        found = _fitted(one, train, settings)
        scores, missed, errors = scores_of(found, residuals)
        tried.append(Confirmed(one.effects, one.gain, found, missed, errors, scores))
    return base, with_probability(tried, base, train, settings)


def _explained(base: Fit, found: Sequence[Fit], further: Problem, settings: Settings) -> bool:
    """Whether one of the contestants explains enough of a further trial to be judged by it."""
    before, *after = (
        float(np.sqrt(np.mean(further(fit.changes)[further.rows] ** 2))) for fit in (base, *found)
    )
    enough, least = complete(further, settings.floor), min(after)
    return least <= enough or before**2 - least**2 >= TELLING * (before**2 - enough**2)


def _fitted(one: Contestant, train: Problem, settings: Settings) -> Fit:
    return fit(
        near(train, one.changes),
        one.names,
        one.changes,
        settings.scale,
        settings.iterations,
        steps=STEPS[-1:],
        exact=False,
    )
