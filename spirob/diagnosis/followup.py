"""Ask, play, decide, prove: what a diagnosis still wants to see, and what stands once it was seen.

The pipeline runs this with a file between each step, the trial in one go on its robots.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from spirob.diagnosis.contest import Contestant, decided_again, in_question, joined, proposed
from spirob.diagnosis.proof import FOUND, Proof, proved, put_to_proof, sifted, to_prove
from spirob.diagnosis.proposals import Proposal
from spirob.diagnosis.rungs import Ladder, Settings
from spirob.diagnosis.verdict import Verdict, judge
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual

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
        verdict = {**plain["verdict"], "equivalents": tuple(plain["verdict"]["equivalents"])}
        decide, prove = (
            tuple(Proposal(**{**one, "trials": tuple(one["trials"])}) for one in plain[key])
            for key in ("decide", "prove")
        )
        models = tuple(Contestant.from_dict(one) for one in plain["models"])
        return Question(Verdict(**verdict), models, decide, prove)


@dataclass(frozen=True)
class Answer:
    """What stands once the experiments were played.

    verdict     the one that stands
    search      the contest that was settled, of one round; None where the first search stands
    models      in question, the one without any effect first
    experiment  that was played to decide, empty where none was
    aside       it told nothing of those in question
    proof       what was found was worth, where it was put to the proof
    """

    verdict: Verdict
    search: Ladder | None = None
    models: tuple[Contestant, ...] = ()
    experiment: str = ""
    aside: bool = False
    proof: Proof | None = None


def asked(
    search: Ladder, verdict: Verdict, problems: Mapping[str, Residual], settings: Settings
) -> Question:
    """What would decide between what was found and those beside it, and what would prove it."""
    validate = problems["validate"]
    decide = proposed(search, verdict, validate, settings)
    prove = to_prove(search, validate, settings) if verdict.kind in FOUND else []
    models = in_question(search, verdict) if decide or prove else ()
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
    search = decided_again(stands.models, own, known, settings, stands.verdict.kind)
    if search is None:
        return replace(stands, experiment=played.name, aside=True)
    return _settled(replace(stands, experiment=played.name), search, own, settings)


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
        stands = _settled(stands, held, own, settings)
    proof = proofs[frozenset(stands.models[1].effects)]
    return replace(stands, verdict=proved(stands.verdict, proof), proof=proof)


def _settled(
    stands: Answer, search: Ladder, own: Mapping[str, Residual], settings: Settings
) -> Answer:
    verdict = judge(search, own, settings)
    return replace(
        stands, verdict=verdict, search=search, models=tuple(in_question(search, verdict))
    )
