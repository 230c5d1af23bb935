"""One case of the trial: a robot with something hidden, recorded, then diagnosed blind.

What is hidden stays on this side of the logs: the diagnosis is handed decoded logs, nothing else.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from spirob.diagnosis.ladder import climb
from spirob.diagnosis.noise import complete
from spirob.diagnosis.rungs import Search, Settings
from spirob.diagnosis.verdict import explained, foretold, judge
from spirob.effects import Effect, all_effects
from spirob.emulator.build import AS_DESIGNED
from spirob.identify.numbers import FITTED
from spirob.identify.problem import effort_rms
from spirob.identify.residual import Residual
from spirob.plant import Plant, Rig
from spirob.trial.answers import ANSWERS, TOGETHER
from spirob.trial.drawn import drawn
from spirob.trial.further import Robot, asked_again, judged
from spirob.trial.oracle import oracle
from spirob.trial.strength import RATIOS


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
    build: str = AS_DESIGNED

    @property
    def name(self) -> str:
        """As it is told."""
        build = "" if self.build == AS_DESIGNED else f"-{self.build}"
        return f"{self.kind.replace('+', '_and_')}-{self.seed}{build}{'-without' * self.without}"

    @property
    def robot(self) -> int:
        """Seed of a robot of its own: cases that share one are not independent, as their rates'
        intervals take them to be."""
        return int(np.random.default_rng([self.seed, *self.kind.encode()]).integers(2**31))


def run(case: Case, settings: Settings | None = None) -> list[dict[str, Any]]:
    """Record, fit, diagnose, and compare with the oracle; one or two results as plain data."""
    settings = settings or Settings(intervals=False, always=False)
    library = list(all_effects().values())
    plant = Plant(Rig(), library)
    hidden, problems, base = drawn(
        case.kind, case.seed, case.robot, plant, settings, case.ratios, case.build
    )
    robot = hidden, case.robot
    search = climb(problems, FITTED, library, {}, settings, known=base)
    first, asked, experiment = judge(search, problems, settings), search, ""
    if first.contested:
        asked, experiment = asked_again(search, first, robot, problems, settings)
    best = oracle(problems, search, _counterparts(case), settings)
    about = {
        "kind": case.kind,
        "seed": case.seed,
        "robot": case.robot,
        "ratios": list(case.ratios),
        "build": case.build,
        "strengths": [float(strength) for _, strength in hidden.parts],
    }
    told = {"first_verdict": first.kind, "experiment": experiment}
    found = [
        {**about, "without": False, **told, **_outcome(asked, robot, problems, best, settings)}
    ]
    found[0]["first"] = list(dict.fromkeys([*found[0]["first"], *_first(search)]))
    if case.without:
        kept = [e for e in library if e.name() not in _right_names(case)]
        blind = climb(problems, FITTED, kept, {}, settings, known=search)
        found.append({**about, "without": True, **_outcome(blind, robot, problems, best, settings)})
    return found


def _outcome(
    search: Search,
    robot: Robot,
    problems: Mapping[str, Residual],
    best: float,
    settings: Settings,
) -> dict[str, Any]:
    """What is said of one robot once a name was put to the proof, and how large the errors are.

    robot  plays the proof;  best  the oracle's error
    """
    first = _first(search)
    search, verdict, proof = judged(search, robot, problems, settings)
    named = [e.name() for e in search.rungs[-1].effects] if verdict.kind == "named" else []
    size = effort_rms(problems["heldout"])
    return {
        "verdict": verdict.kind,
        "named": named,
        "rivals": list(verdict.rivals),
        "probability": float(verdict.probability),
        "first": first,
        "proof": None if proof is None else asdict(proof),
        "accounted": {
            "validate": explained(search, complete(problems["validate"], settings.floor)),
            "heldout": foretold(search, problems["heldout"], settings),
        },
        "heldout": {
            "base": search.rungs[0].scores["heldout"].rmse / size,
            "named": (search.rungs[-1] if named else search.rungs[0]).scores["heldout"].rmse / size,
            "oracle": best / size,
        },
    }


def _right_names(case: Case) -> set[str]:
    return {name for kind in case.kind.split("+") for name in ANSWERS[kind] if name}


def _counterparts(case: Case) -> Sequence[type[Effect]]:
    kinds = case.kind.split("+")
    names = [n for kind in kinds for n in TOGETHER.get(kind, ANSWERS[kind][:1])]
    return [all_effects()[name] for name in names if name]


def _first(search: Search) -> list[str]:
    """The candidates of the first round, best first."""
    first = search.rounds[0] if search.rounds else []
    return [e.name() for c in first for e in c.effects]
