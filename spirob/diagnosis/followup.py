"""What a diagnosis still wants to see: ask, play, decide, and put the name to the proof.

A name is put to the proof: it has to hold under a softer pull than any it was found under.

A law that imitates the missing one does so on the trials in which it was found.  Play of a gear
passes for a soft tendon while both tendons pull; dry friction and saturation pass for a loss that
grows with the load.  Where hardly anything pulls they part.  So soft pulls are played on either
side.  The longer ones join those that are fitted, and the model with the name and the one without
are fitted again; on the shorter ones the name has to account for most of what is missing there,
too.  Either motor pulls in both: an effect has numbers of each, and what is asked of one has to
have been seen of it.  A proof makes a name surer or less sure, and takes it away where it is no
longer likely.  Where others stand beside it, as rivals or because they say the same of the data,
they are put to the same proof, and who does not hold is out: a soft tendon that passes for play
leaves the name to play.

Only what is softer proves: where a trial is faster, stronger or deeper than what was fitted, more
happens than a right law says.

The pipeline runs this with a file between each step, the trial in one go on its robots.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from spirob.diagnosis.certainty import Ended
from spirob.diagnosis.conclusion import Weighed, likely, weigh
from spirob.diagnosis.contest import (
    Contestant,
    compared,
    decided_again,
    further_of,
    in_question,
    joined,
    proposed,
    settled,
)
from spirob.diagnosis.criteria import Settings, complete
from spirob.diagnosis.proposals import Played, Proposal, on_either_side, proposal
from spirob.diagnosis.verdict import AGAIN, ATLAS, Verdict, judge
from spirob.effects import Effect
from spirob.identify.measurement import Measurement
from spirob.identify.problem import Problem, rms
from spirob.identify.residual import Residual

FOUND = ("named", "undecided")  # verdicts that hold names

# What may be left under a soft pull, besides the noise, over the effort: builds of a machine from
# which nothing is missing differ by this much at most (docs/lab/search_of_the_arm.md).
USUAL = 0.009

# Share of the squared error that a name has to account for where more is left: right names account
# for more of it, a name that imitates another for less (docs/lab/search_of_the_arm.md).
HOLDS = 0.8

# Under so soft a pull tendons go slack and taut again.  Rivals are compared by their errors in
# ampere, among which those of so small a current would not count: it puts a name to the proof.
SOFT = {"kind": "constant", "value": 0.15}
LONGER: Played = ("soft pull", ((0.1, 0.0), (1.0, 0.02), (1.9, 0.005)), SOFT)
SHORTER: Played = ("short soft pull", ((0.1, 0.0), (0.9, 0.016), (2.0, 0.003)), SOFT)
TRIALS = (
    *on_either_side(LONGER, ("train", "train")),
    *on_either_side(SHORTER, ("validate", "validate")),
)


@dataclass(frozen=True)
class Proof:
    """What a name was worth in an experiment of its own.

    experiment  its name;  share  of the squared error there, above the sensor's noise and
                the floor, that the named effects account for; 1 where no more is left than of a
                machine from which nothing is missing
    """

    experiment: str
    share: float

    @property
    def holds(self) -> bool:
        """Whether that is enough to stand where others do not."""
        return self.share >= HOLDS


Proofs = Mapping[frozenset[type[Effect]], Proof]  # by the effects of a name


def to_prove(ended: Ended) -> list[Proposal]:
    """The experiment that puts what was found to the proof.

    None where nothing was found, or where it would show less there than counts as an effect.
    """
    models, found = ended.search.models, ended.found
    if not found.chosen.effects:
        return []
    without, named = (m.fit.changes for m in (found.rungs[0], found.chosen))
    best = proposal(models.validate, LONGER[0], TRIALS, without, named)
    if best is None or best.share <= models.least / models.size:
        return []
    return [replace(best, proves=True)]


def put_to_proof(
    experiment: str,
    models: Sequence[Contestant],
    own: Mapping[str, Residual],
    known: Mapping[str, Residual],
    settings: Settings,
) -> Proofs:
    """What each name accounts for on a further trial.

    models  without any effect, then those in question
    own     the trials in which the effect was found;  known  the same with the further ones
    """
    base, *tried = compared(models, known, settings).tried.values()
    further = further_of(own, known)
    before = _rms(further, base.fit.changes)
    usual = complete(further, max(settings.floor, USUAL))
    floor = complete(further, settings.floor)
    found = {}
    for one in tried:
        after = _rms(further, one.fit.changes)
        share = 1.0  # of what is above the floor, gone
        if after > usual:
            share = (before**2 - after**2) / max(before**2 - floor**2, 1e-300)
        found[frozenset(one.effects)] = Proof(experiment, share)
    return found


def sifted(
    models: Sequence[Contestant],
    proofs: Proofs,
    own: Mapping[str, Residual],
    settings: Settings,
) -> Ended | None:
    """The contest among the names that hold.

    None where all hold, or none: then the proof tells nothing of which it is.
    """
    base, *names = models
    hold = [m for m in names if proofs[frozenset(m.effects)].holds]
    if len(hold) in (0, len(names)):
        return None
    among = compared([base, *hold], own, settings)
    return settled(among, among, settings)


def alone(
    models: Sequence[Contestant],
    kept: Sequence[str],
    own: Mapping[str, Residual],
    settings: Settings,
) -> Ended:
    """What was found, without those of its effects that a proof leaves unlikely."""
    base, whole, *_ = models
    effects = tuple(e for e in whole.effects if e.name() in kept)
    off = {e.name() for e in whole.effects} - set(kept)
    names = tuple(n for n in whole.names if n.partition(".")[0] not in off)
    among = compared([base, replace(whole, effects=effects, names=names)], own, settings)
    return settled(among, among, settings)


def proved(verdict: Verdict, proof: Proof) -> Verdict:
    """The verdict that stands after the proof of what was found."""
    if verdict.kind != "named":
        return verdict
    weighed = {
        name: one.proven(proof.share) if name in verdict.named else one
        for name, one in verdict.weighed.items()
    }
    if likely(weighed) == verdict.named:
        return replace(verdict, weighed=weighed, next_experiment="")
    return Verdict("unknown", weighed, *disproved(verdict.sentence, proof))


def disproved(sentence: str, proof: Proof) -> tuple[str, str, str]:
    """Sentence, explanation and next experiment instead of a name that did not hold."""
    name = sentence.removeprefix("Missing: ").rstrip(".")
    return (
        f"Something is missing that the library does not hold: not {name}.",
        f"The best explanation, {name}, did not hold on '{proof.experiment}', a trial of its own: "
        f"it accounts for {max(proof.share, 0.0):.0%} of the squared error there. {ATLAS}",
        AGAIN,
    )


def _rms(further: Problem, changes: Mapping[str, float]) -> float:
    return rms(further(changes)[further.rows])


# Plays an experiment on the machine: its logs by role, none where it was not played to its end.
Play = Callable[[Proposal], Mapping[str, Sequence[Measurement]]]


@dataclass(frozen=True)
class Question:
    """What is left to play of a diagnosis.

    verdict  as it stands;  models  in question, the one without any effect first
    decide   experiments that tell what was found from what else it may be, best first
    prove    experiments that put a name to the proof, best first
    """

    verdict: Verdict
    models: tuple[Contestant, ...] = ()
    decide: tuple[Proposal, ...] = ()
    prove: tuple[Proposal, ...] = ()

    @property
    def wanted(self) -> list[Proposal]:
        """What to play: the best of each."""
        return [*self.decide[:1], *self.prove[:1]]

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for another process to go on from."""
        return {**asdict(self), "models": [m.as_dict() for m in self.models]}

    @staticmethod
    def from_dict(plain: Mapping[str, Any]) -> "Question":
        """Back from plain data."""
        told = plain["verdict"]
        weighed = {name: Weighed(**one) for name, one in told["weighed"].items()}
        verdict = Verdict(**{**told, "weighed": weighed, "doubts": tuple(told["doubts"])})
        decide, prove = (
            tuple(Proposal(**{**one, "trials": tuple(one["trials"])}) for one in plain[key])
            for key in ("decide", "prove")
        )
        models = tuple(Contestant.from_dict(one) for one in plain["models"])
        return Question(verdict, models, decide, prove)


@dataclass(frozen=True)
class Answer:
    """What stands once the experiments were played.

    verdict     the one that stands
    ended       the contest that was settled; None where the first search stands
    models      in question, the one without any effect first
    experiment  that was played to decide, empty where none was
    aside       it told nothing of those in question
    proof       what was found was worth, where it was put to the proof
    """

    verdict: Verdict
    ended: Ended | None = None
    models: tuple[Contestant, ...] = ()
    experiment: str = ""
    aside: bool = False
    proof: Proof | None = None


def asked(ended: Ended, verdict: Verdict) -> Question:
    """What would decide between what was found and those beside it, and what would prove it."""
    decide = proposed(ended, verdict)
    prove = to_prove(ended) if verdict.kind in FOUND else []
    models = in_question(ended, verdict) if decide or prove else ()
    return Question(verdict, tuple(models), tuple(decide), tuple(prove))


def answered(
    question: Question, own: Mapping[str, Residual], play: Play, settings: Settings
) -> Answer:
    """Play what is asked for, decide, and put to the proof what was found.

    own  the trials in which it was found, by role
    Where nothing is asked, nothing could be played, or what was played tells nothing of those in
    question, the diagnosis stands as it is.
    """
    stands = Answer(question.verdict, models=question.models)
    for best in question.decide[:1]:
        if logs := play(best):
            stands = _decided(stands, best, own, joined(own, logs), settings)
    for best in question.prove[:1]:
        if stands.verdict.kind in FOUND and (logs := play(best)):
            stands = _proved(stands, best, own, joined(own, logs), settings)
    return stands


def _decided(
    stands: Answer,
    played: Proposal,
    own: Mapping[str, Residual],
    known: Mapping[str, Residual],
    settings: Settings,
) -> Answer:
    ended = decided_again(stands.models, own, known, settings, stands.verdict.kind)
    if ended is None:
        return replace(stands, experiment=played.name, aside=True)
    return _settled(replace(stands, experiment=played.name), ended)


def _proved(
    stands: Answer,
    played: Proposal,
    own: Mapping[str, Residual],
    known: Mapping[str, Residual],
    settings: Settings,
) -> Answer:
    proofs = put_to_proof(played.name, stands.models, own, known, settings)
    held = sifted(stands.models, proofs, own, settings)
    if held is not None:
        stands = _settled(stands, held)
    proof = proofs[frozenset(stands.models[1].effects)]
    verdict, named = proved(stands.verdict, proof), stands.verdict.named
    kept = likely(verdict.weighed)
    if not named or not 0 < len(kept) < len(named):
        return replace(stands, verdict=verdict, proof=proof)
    fewer = _settled(stands, alone(stands.models, kept, own, settings))
    if fewer.verdict.kind in FOUND:
        return _proved(fewer, played, own, known, settings)
    return replace(fewer, proof=proof)


def _settled(stands: Answer, ended: Ended) -> Answer:
    verdict = judge(ended, weigh(ended))
    models = in_question(ended, verdict)
    return replace(stands, verdict=verdict, ended=ended, models=tuple(models))
