"""One case of the trial: a robot with something hidden, recorded, then diagnosed blind.

What is hidden stays on this side of the logs: the diagnosis is handed decoded logs, nothing else.

The oracle: the error that remains once the right effect is known.

The library's counterpart of what is hidden is added and everything refitted.  No diagnosis can be
expected to do better, and where the oracle gains nothing, nothing can be named.  Its own fit must
not be what fails, so it begins at the base and from afar too, as that of a leader of the search.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from spirob.campaign.arm.rates import ANSWERS, TOGETHER
from spirob.campaign.arm.recording import recorded
from spirob.campaign.arm.strength import RATIOS, drawn
from spirob.diagnosis.backward import to_the_end
from spirob.diagnosis.confirm import confirm
from spirob.diagnosis.followup import Play, answered, asked
from spirob.diagnosis.ladder import begun, climb
from spirob.diagnosis.proposals import Proposal
from spirob.diagnosis.rungs import Ladder, Rung, Settings, floor_at, weighed_at
from spirob.diagnosis.screen import screen
from spirob.diagnosis.verdict import judge
from spirob.effects import Effect, all_effects
from spirob.emulator.build import TYPICAL
from spirob.identify.builds import Floor
from spirob.identify.fit import STEPS, Fit
from spirob.identify.measurement import Measurement
from spirob.identify.problem import FITTED, Problem, effort_rms
from spirob.identify.residual import Residual, near
from spirob.machine.composed.arm import composed_for_arm
from spirob.plant import Plant, Rig

ENOUGH = 0.6  # of the base's error: with less the fit did not fail


def oracle(
    problems: Mapping[str, Problem],
    search: Ladder,
    effects: Sequence[type[Effect]],
    settings: Settings,
) -> float:
    """RMSE on held-out trials with `effects` added, at most the base's; in the effort's unit.

    What the search has already fitted is not fitted again.
    """
    base, wanted = search.rungs[0], set(effects)
    # what the data did not tell without the effect they may tell with it
    names = [*base.fit.estimates, *search.vague]
    found = [r.scores for r in search.rungs if set(r.effects) == wanted]
    found += [c.scores for tried in search.rounds[:1] for c in tried if set(c.effects) == wanted]
    errors = [base.scores["heldout"].rmse, *(s["heldout"].rmse for s in found)]
    if effects and (not found or min(errors) > ENOUGH * errors[0]):
        errors.append(_fitted(problems, base, names, effects, settings))
    return min(errors)


def _fitted(
    problems: Mapping[str, Problem],
    base: Rung,
    names: Sequence[str],
    effects: Sequence[type[Effect]],
    settings: Settings,
) -> float:
    train = near(problems["train"], base.fit.changes)
    started = screen(train, base.fit, names, effects, settings.scale)
    found = confirm(started, base, {**problems, "train": train}, settings, _silent)
    return to_the_end(found, problems, settings, _silent).scores["heldout"].rmse


def _silent(text: str) -> None:
    pass


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
    alone = first.base.fit
    problems = weighed_at(alone.changes, list(alone.estimates), played, settings.scale)
    base = begun(problems, FITTED, alone.changes, settings, STEPS[-1:])

    floors: dict[tuple[object, ...], Floor] = {}

    def floor(found: Fit) -> Floor:
        """Measured once for each fit: the search without the right names begins with the same."""
        at = (*found.estimates, *found.changes.items())
        if at not in floors:
            floors[at] = floor_at(found, problems, settings.scale)
        return floors[at]

    search = climb(problems, FITTED, library, {}, settings, known=base, measure=floor)
    best = oracle(problems, search, _counterparts(case), settings)
    searches = {False: search}
    if case.without:
        kept = [e for e in library if e.name() not in _right_names(case)]
        searches[True] = climb(problems, FITTED, kept, {}, settings, known=search, measure=floor)
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
            **_outcome(found, problems, play, best, found.settings(settings)),
        }
        for without, found in searches.items()
    ]


def _outcome(
    search: Ladder,
    problems: Mapping[str, Residual],
    play: Play,
    best: float,
    settings: Settings,
) -> dict[str, Any]:
    """What is said of one robot once all that was asked for was played, and how large errors are.

    best  the oracle's error
    """
    first = judge(search, problems, settings)
    answer = answered(asked(search, first, problems, settings), problems, play, settings)
    last, verdict = answer.search or search, answer.verdict
    named = [e.name() for e in last.rungs[-1].effects] if verdict.kind == "named" else []
    size = effort_rms(problems["heldout"])
    return {
        "first_verdict": first.kind,
        "experiment": answer.experiment + ", set aside" * answer.aside,
        "verdict": verdict.kind,
        "named": named,
        "rivals": list(verdict.rivals),
        "probability": float(verdict.probability),
        "first": list(dict.fromkeys([*_first(last), *_first(search)])),
        "proof": None if answer.proof is None else asdict(answer.proof),
        "composed": _composed(search, problems, settings) if verdict.kind == "unknown" else None,
        "evidence": {"first": dict(first.evidence), "last": dict(verdict.evidence)},
        "floor": settings.floor,
        "heldout": {
            "base": search.rungs[0].scores["heldout"].rmse / size,
            "named": (last.rungs[-1] if named else search.rungs[0]).scores["heldout"].rmse / size,
            "oracle": best / size,
        },
    }


def _composed(
    search: Ladder, problems: Mapping[str, Residual], settings: Settings
) -> dict[str, Any] | None:
    """The law of what the fitted numbers leave: its terms, and the error that it leaves."""
    base, best = search.rungs[0].fit, min(search.rungs, key=lambda r: r.scores["validate"].rmse)
    last = {role: score.rmse for role, score in best.scores.items()}
    law = composed_for_arm(problems, list(base.estimates), base.changes, last, settings)
    if law is None:
        return None
    error = law.document["rmse"]["test"] / effort_rms(problems["heldout"])
    return {"terms": law.document["terms"], "heldout": error}


def _right_names(case: Case) -> set[str]:
    return {name for kind in case.kind.split("+") for name in ANSWERS[kind] if name}


def _counterparts(case: Case) -> Sequence[type[Effect]]:
    kinds = case.kind.split("+")
    names = [n for kind in kinds for n in TOGETHER.get(kind, ANSWERS[kind][:1])]
    return [all_effects()[name] for name in names if name]


def _first(search: Ladder) -> list[str]:
    """The candidates of the first round, best first."""
    first = search.rounds[0] if search.rounds else []
    return [e.name() for c in first for e in c.effects]
