"""A name is put to the proof: it has to hold on the trial that would show it most.

A law that imitates the missing one does so on the trials in which it was found.  Play of a gear
passes for a soft tendon, and a tendon for play, while both tendons pull; under a load that hardly
holds them taut the two part.  So the trial on which the model with the name and the one without
differ most, relative to the effort there, is played on either side.  One of its logs joins those
that are fitted, and both models are fitted again; on the other the name has to account for as much
as it had to where it was found.  A proof takes a name away or lets it stand; it gives none.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spirob.diagnose.again import compared, further_of
from spirob.diagnose.contest import Contestant
from spirob.diagnose.noise import complete
from spirob.diagnose.proposals import PROOFS, Proposal, propose
from spirob.diagnose.rungs import Search, Settings
from spirob.diagnose.verdict import AGAIN, ATLAS, Verdict, share_of
from spirob.identify.problem import Problem
from spirob.identify.residual import Residual

# What machines from which nothing is missing leave beside the noise, over the effort, where that is
# more than the floor: the most of ten emulated robots (building seeds 3500 to 3509), which left
# 0.65 to 0.87 % there, 0.44 to 0.54 % of it noise.  On the other trials they left up to the floor.
USUAL = {"soft pull": 0.0073}


@dataclass(frozen=True)
class Proof:
    """What a name was worth on a trial of its own.

    experiment  name of the trial;  share  of the squared error there, above the sensor's noise and
                the floor, that the named effects account for; 1 where no more is left than of a
                machine from which nothing is missing
    """

    experiment: str
    share: float

    def holds(self, settings: Settings) -> bool:
        """Whether that is enough for the name to stand."""
        return self.share >= settings.explained


def to_prove(search: Search, problem: Residual, settings: Settings) -> list[Proposal]:
    """Experiments that would show what was found, that which shows it most first.

    None where nothing was, or where it would show less than counts as an effect on them all.
    """
    if not search.rungs[-1].effects:
        return []
    without, named = (r.fit.changes for r in (search.rungs[0], search.rungs[-1]))
    every = propose(problem, without, named, PROOFS)
    return [replace(p, proves=True) for p in every if p.share > settings.floor]


def models_of(search: Search) -> tuple[Contestant, Contestant]:
    """The model without any effect and the one with what was found, to be fitted again."""
    one, other = (
        Contestant(tuple(r.effects), tuple(r.fit.estimates), r.fit.changes)
        for r in (search.rungs[0], search.rungs[-1])
    )
    return one, other


def put_to_proof(
    experiment: str,
    models: Sequence[Contestant],
    own: Mapping[str, Residual],
    known: Mapping[str, Residual],
    settings: Settings,
) -> Proof:
    """What a name accounts for on a further trial.

    models  without any effect, and with the named
    own     the trials in which the effect was found;  known  the same with the further ones
    """
    base, (named,) = compared(models, known, settings)
    further = further_of(own, known)
    before, after = (_rms(further, found.fit.changes) for found in (base, named))
    if after <= complete(further, max(settings.floor, USUAL.get(experiment, 0.0))):
        return Proof(experiment, 1.0)
    return Proof(experiment, share_of(before**2, after**2, complete(further, settings.floor)))


def proved(verdict: Verdict, proof: Proof, settings: Settings) -> Verdict:
    """The verdict that stands after the proof."""
    if proof.holds(settings):
        return replace(verdict, next_experiment="")
    said = disproved(verdict.sentence, proof)
    return Verdict(
        "unknown", 0.0, [], said["sentence"], said["explanation"], said["next_experiment"]
    )


def disproved(sentence: str, proof: Proof) -> dict[str, str]:
    """What is said instead of a name that did not hold; `sentence` said it."""
    name = sentence.removeprefix("Missing: ").rstrip(".")
    return {
        "sentence": f"Something is missing that the library does not hold: not {name}.",
        "explanation": (
            f"The best explanation, {name}, did not hold on '{proof.experiment}', the trial that "
            f"would show it most: it accounts for {max(proof.share, 0.0):.0%} of the squared error "
            f"there. {ATLAS}"
        ),
        "next_experiment": AGAIN,
    }


def _rms(further: Problem, changes: Mapping[str, float]) -> float:
    return float(np.sqrt(np.mean(further(changes)[further.rows] ** 2)))
