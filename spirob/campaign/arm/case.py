"""One case of the trial: a robot with something hidden, recorded, then diagnosed blind.

What is hidden stays on this side of the logs: the diagnosis is handed decoded logs, nothing else.

Beside each case stands its oracle, the error that remains once the right effect is known: the
library's counterpart of what is hidden is added and everything refitted.  No diagnosis can be
expected to do better, and where the oracle gains nothing, nothing can be named.  Its own fit must
not be what fails, so it begins at the base and from afar too, as that of a leader of the search.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from spirob.campaign.arm.bends import recorded
from spirob.campaign.arm.rates import ANSWERS, TOGETHER, answers
from spirob.campaign.arm.strength import RATIOS, drawn
from spirob.diagnosis.certainty import Ended
from spirob.diagnosis.criteria import Settings, floor_at, weighed_at
from spirob.diagnosis.fitting import begun
from spirob.diagnosis.followup import Play, answered, asked
from spirob.diagnosis.proposals import Proposal
from spirob.diagnosis.simulated import Simulated
from spirob.diagnosis.verdict import Verdict, searched
from spirob.effects import Effect, all_effects
from spirob.emulator.build import TYPICAL
from spirob.identify.fit import STEPS
from spirob.identify.measurement import Measurement
from spirob.identify.problem import FITTED, effort_rms
from spirob.machine.composed.arm import Rival, composed_for_arm
from spirob.plant import Plant, Rig

ENOUGH = 0.6  # of the base's error: with less the fit did not fail


def oracle(models: Simulated, effects: Sequence[type[Effect]]) -> float:
    """RMSE on held-out trials with `effects` added, at most the base's; in the effort's unit.

    What the search has already fitted is not fitted again where that did not fail.
    """
    base, key = models.fitted((), {}), frozenset(e.name() for e in effects)
    found = models.tried.get(key, base)
    if effects and found.heldout_square > ENOUGH**2 * base.heldout_square:
        if key not in models.tried:
            sets = [tuple(models.offers(base, effects))]
            models.grown(base, sets, lambda before, after: False)
        found = models.settled(models.tried[key])
    return float(np.sqrt(min(base.heldout_square, found.heldout_square)))


@dataclass(frozen=True)
class Case:
    """What is hidden in which robot.

    kind     of the emulator, "none", or two joined by "+"
    seed     draws, with the kind, the robot, the sizes of the effect and its strength
    without  diagnose once more with a library that lacks every right answer: it must not name
             another with confidence
    ratios   between which knowing the effect would bring the held-out error
    build    how the robot is built
    """

    kind: str
    seed: int
    without: bool = False
    ratios: tuple[float, float] = RATIOS
    build: str = TYPICAL

    @property
    def name(self) -> str:
        """As it is told."""
        build = "" if self.build == TYPICAL else f"-{self.build}"
        return f"{self.kind.replace('+', '_and_')}-{self.seed}{build}{'-without' * self.without}"

    @property
    def robot(self) -> int:
        """Seed of a robot of its own: cases that share one are not independent, as their rates'
        intervals take them to be."""
        return int(np.random.default_rng([self.seed, *self.kind.encode()]).integers(2**31))


def quickly(settings: Settings) -> Settings:
    """The same without what only a report shows."""
    return replace(settings, intervals=False, always=False)


def run(case: Case, settings: Settings | None = None) -> list[dict[str, Any]]:
    """Record, fit, diagnose, and compare with the oracle; one or two results as plain data."""
    settings = settings or quickly(Settings())
    library = list(all_effects().values())
    plant = Plant(Rig(), library)
    hidden, played, first = drawn(
        case.kind, case.seed, case.robot, plant, settings, case.ratios, case.build
    )
    alone = first.fit
    problems = weighed_at(alone.changes, list(alone.estimates), played, settings.scale)
    start = begun(problems["train"], FITTED, alone.changes, settings, STEPS[-1:])
    models = Simulated(
        problems,
        FITTED,
        settings,
        start,
        lambda found: floor_at(found, problems, settings.scale),
    )
    right = answers(case.kind)
    ended = {False: searched(models, library, settings)}
    if case.without:
        kept = [e for e in library if e.name() not in right]
        ended[True] = searched(models.without(right), kept, settings)
    best = oracle(models, _counterparts(case))
    about = {
        "kind": case.kind,
        "seed": case.seed,
        "robot": case.robot,
        "ratios": list(case.ratios),
        "build": case.build,
        "strengths": [float(strength) for _, strength in hidden.parts],
    }

    def play(experiment: Proposal) -> dict[str, list[Measurement]]:
        return recorded(hidden, case.robot, experiment.trials)

    return [
        {
            **about,
            "without": without,
            **_outcome(*found, play, best, settings),
        }
        for without, found in ended.items()
    ]


def _outcome(
    ended: Ended, first: Verdict, play: Play, best: float, settings: Settings
) -> dict[str, Any]:
    """What is said of one robot once all that was asked for was played, and how large errors are.

    best  the oracle's error
    """
    models: Simulated = ended.search.models
    floor = models.floor_of(ended.found.chosen).share
    settings = replace(settings, floor=floor)
    answer = answered(asked(ended, first), models.residuals, play, settings)
    last, verdict = answer.ended or ended, answer.verdict
    chosen, bare = last.found.chosen, ended.found.rungs[0]
    named = [e.name() for e in chosen.effects] if verdict.kind == "named" else []
    size = effort_rms(models.heldout)
    errors = {"base": bare, "named": chosen if named else bare}
    return {
        "first_verdict": first.kind,
        "experiment": answer.experiment + ", set aside" * answer.aside,
        "verdict": verdict.kind,
        "named": named,
        "rivals": list(verdict.rivals),
        "probability": float(verdict.probability),
        "first": _first(last, ended),
        "proof": None if answer.proof is None else asdict(answer.proof),
        "composed": _composed(ended, settings) if verdict.kind == "unknown" else None,
        "evidence": {"first": _evidence(first), "last": _evidence(verdict)},
        "floor": floor,
        "heldout": {
            **{key: float(np.sqrt(m.heldout_square)) / size for key, m in errors.items()},
            "oracle": best / size,
        },
    }


def _evidence(verdict: Verdict) -> dict[str, Any]:
    return {name: one.as_dict() for name, one in verdict.weighed.items()}


def _composed(ended: Ended, settings: Settings) -> dict[str, Any] | None:
    """The law of what the fitted numbers leave: its terms, and the error that it leaves."""
    models, rungs = ended.search.models, ended.found.rungs
    base = rungs[0].fit
    best = min(rungs, key=lambda m: m.mean_square)
    errors = {role: score.rmse for role, score in models.scores(best).items()}
    rival, names = Rival(errors, len(best.effects)), list(base.estimates)
    law = composed_for_arm(models.residuals, names, base.changes, rival, settings)
    if law is None:
        return None
    error = law.document["rmse"]["test"] / effort_rms(models.heldout)
    return {"terms": law.document["terms"], "heldout": error}


def _counterparts(case: Case) -> Sequence[type[Effect]]:
    kinds = case.kind.split("+")
    names = [n for kind in kinds for n in TOGETHER.get(kind, ANSWERS[kind][:1])]
    return [all_effects()[name] for name in names if name]


def _first(*ended: Ended) -> list[str]:
    """Names of the candidates that were fitted, those of what was decided last first."""
    found: list[str] = []
    for one in ended:
        tried = one.search.models.tried.values()
        ranked = sorted((m for m in tried if m.effects), key=lambda m: m.mean_square)
        found += [e.name() for m in ranked for e in m.effects]
    return list(dict.fromkeys(found))
