"""Further trials on the robot of a case: what decides between rivals, and what proves a name."""

from collections.abc import Mapping

from spirob.diagnosis.again import decided_again, joined, proposed
from spirob.diagnosis.contest import contest, in_question
from spirob.diagnosis.proof import FOUND, Proof, proved, put_to_proof, sifted, to_prove
from spirob.diagnosis.rungs import Search, Settings
from spirob.diagnosis.verdict import Verdict, judge
from spirob.emulator.rig import HiddenSettings
from spirob.identify.residual import Residual
from spirob.trial.played import recorded

Robot = tuple[HiddenSettings, int]  # what is hidden in it, and its seed


def asked_again(
    search: Search,
    contested: Verdict,
    robot: Robot,
    problems: Mapping[str, Residual],
    settings: Settings,
) -> tuple[Search, str]:
    """The experiment that separates the rivals best, played on the same robot, and what it says."""
    proposals = proposed(search, contested, problems["validate"], settings)
    if not proposals:
        return search, ""
    best = proposals[0]
    known = joined(problems, recorded(*robot, best.trials))
    asked = decided_again(contest(search, contested), problems, known, settings, contested.kind)
    return (search, f"{best.name}, set aside") if asked is None else (asked, best.name)


def judged(
    search: Search,
    robot: Robot,
    problems: Mapping[str, Residual],
    settings: Settings,
) -> tuple[Search, Verdict, Proof | None]:
    """The verdict, and what its name was worth on a trial of its own, played on the same robot.

    The search is that of the names that hold there, where others stood beside what was found.
    """
    verdict = judge(search, problems, settings)
    if verdict.kind not in FOUND:
        return search, verdict, None
    experiments = to_prove(search, problems["validate"], settings)
    if not experiments:
        return search, verdict, None
    best = experiments[0]
    known = joined(problems, recorded(*robot, best.trials))
    models = in_question(search, verdict)
    proofs = put_to_proof(best.name, models, problems, known, settings)
    left = sifted(models, proofs, problems, settings)
    if left is not None:
        search, verdict = left, judge(left, problems, settings)
    proof = proofs[frozenset(search.rungs[-1].effects)]
    return search, proved(verdict, proof), proof
