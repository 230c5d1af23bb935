"""Who stands beside what was found, and the decision between them by further trials.

Trials are played where two explanations differ most.  They lie outside of what was fitted, where no
model is complete: numbers that hardly showed before weigh there, other currents flow, and things
happen that no effect in question is the cause of.  So they only say *which* of the contestants it
is.  One of them, with the one motor in the lead, joins those that are fitted, and the contestants
are fitted again; the other, with the other motor, joins those on which they are compared.  How much
is explained, and whether that is enough, is judged where the effect was found.  A further trial
that no contestant explains says nothing of them and is set aside; so is one that leaves two beside
each other which said the same where they were found: it was to say which, and one name for both is
the better answer.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from spirob.diagnosis.certainty import Ended
from spirob.diagnosis.conclusion import concluded, weigh
from spirob.diagnosis.criteria import Settings, Worth, complete
from spirob.diagnosis.fitting import Begun, briefly
from spirob.diagnosis.model import Found, Model, Offer, alike
from spirob.diagnosis.proposals import Proposal, propose
from spirob.diagnosis.search import Search
from spirob.diagnosis.simulated import Simulated
from spirob.diagnosis.verdict import Verdict, judge
from spirob.effects import Effect, find_effects
from spirob.identify.fit import Fit
from spirob.identify.measurement import Measurement
from spirob.identify.problem import Problem, rms
from spirob.identify.residual import Residual, near

ArmSearch = Search[Simulated]


@dataclass(frozen=True)
class Contestant:
    """A fitted model that stands beside others.

    effects  none for the model without any;  names  of what is fitted;  changes  where that ended
    """

    effects: tuple[type[Effect], ...]
    names: tuple[str, ...]
    changes: Mapping[str, float]

    @staticmethod
    def of(model: Model) -> "Contestant":
        """A model of a search."""
        return Contestant(model.effects, tuple(model.fit.estimates), model.fit.changes)

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for another process to go on from."""
        plain = {"names": list(self.names), "changes": dict(self.changes)}
        return {"effects": [e.name() for e in self.effects], **plain}

    @staticmethod
    def from_dict(plain: Mapping[str, Any]) -> "Contestant":
        """Back from plain data."""
        effects = tuple(find_effects(plain["effects"]))
        return Contestant(effects, tuple(plain["names"]), dict(plain["changes"]))


def in_question(ended: Ended, verdict: Verdict) -> list[Contestant]:
    """The model without any effect, the one with what was found, and those beside it, if any."""
    models = [ended.found.rungs[0], ended.found.chosen, *beside(ended, verdict)]
    return [Contestant.of(model) for model in models]


def beside(ended: Ended, verdict: Verdict) -> list[Model]:
    """Models in which a rival or an equivalent takes an effect's place, the best first."""
    chosen, tried = ended.found.chosen, ended.search.models.tried
    models: dict[frozenset[str], Model] = {}
    for effect in chosen.effects if verdict.contested else ():
        one = verdict.weighed[effect.name()]
        for other in (*one.rivals, *one.equivalents):
            key = chosen.names - {effect.name()} | {other}
            if key in tried:
                models[key] = tried[key]
    return sorted(models.values(), key=lambda m: m.mean_square)


TELLING = 0.5  # of a further trial's squared error above the floor that one contestant explains


def proposed(ended: Ended, verdict: Verdict) -> list[Proposal]:
    """Experiments that would tell what was found from what else it may be, best first.

    None where the two differ by less than counts as an effect on all of them: two names of one law.
    """
    models, others = ended.search.models, beside(ended, verdict)
    if not others:
        return []
    every = propose(models.validate, ended.found.chosen.fit.changes, others[0].fit.changes)
    return [p for p in every if p.share > models.least / models.size]


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
) -> Ended | None:
    """A contest settled by further trials, to be judged on the first ones.

    own     the trials in which the effect was found;  known  the same with the further ones
    before  the kind of verdict that stands on `own`: named, if they say the same there
    What each explains is taken from `own`; who is another's rival, or says the same, from `known`:
    two say the same only where they do so in the further trials, too.
    None where the further trials show what no contestant explains, or do not tell which of those
    that said the same it is.
    """
    wide = compared(models, known, settings)
    if not _explained(wide, further_of(own, known), settings):
        return None
    found = settled(compared(models, own, settings), wide, settings)
    open_still = before == "named" and judge(found, weigh(found)).kind == "undecided"
    return None if open_still else found


def settled(own: Simulated, wide: Simulated, settings: Settings) -> Ended:
    """A settled contest, to be judged on the trials that began it.

    own  the contestants as `compared` on these trials;  wide  the same where it is settled
    """
    worth = Worth(settings, wide.least)
    bare, *contest = wide.tried.values()
    won = worth.simplest(contest)
    search: ArmSearch = Search(own, [], settings)
    chosen = own.finished(own.tried[won.names])
    ranked = sorted((m for m in own.tried.values() if m.effects), key=lambda m: m.mean_square)
    offers = [Offer(m.effects[-1], dict(m.fit.changes), m.mean_square) for m in ranked]
    found = Found(search.rungs(chosen), offers)
    for effect in chosen.effects:
        search.without(chosen, effect)
        rest, name = chosen.names - {effect.name()}, effect.name()
        found.rivals[name], found.equivalents[name] = [], []
        for other in contest:
            names = other.names - rest
            # what holds the found and more was left for being hardly better: no other explanation
            if other is won or len(names) != 1 or won.names < other.names:
                continue
            same = alike(won, other, worth.least)
            rival = worth.matters(bare, other) and not worth.clearly(other, won)
            if same or rival:
                (found.equivalents if same else found.rivals)[name] += names
    return concluded(search, found)[0]


def compared(
    models: Sequence[Contestant], residuals: Mapping[str, Problem], settings: Settings
) -> Simulated:
    """All fitted again to these trials, the model without an effect first."""
    start, *others = models
    train = residuals["train"]
    found = Simulated(residuals, start.names, settings, Begun(_fitted(start, train, settings)))
    for one in others:
        found.added(one.effects, _fitted(one, train, settings))
    return found


def _explained(wide: Simulated, further: Problem, settings: Settings) -> bool:
    """Whether one of the contestants explains enough of a further trial to be judged by it."""
    before, *after = (rms(further(m.fit.changes)[further.rows]) for m in wide.tried.values())
    enough, least = complete(further, settings.floor), min(after)
    return least <= enough or before**2 - least**2 >= TELLING * (before**2 - enough**2)


def _fitted(one: Contestant, train: Problem, settings: Settings) -> Fit:
    return briefly(near(train, one.changes), one.names, one.changes, settings)
