"""One case of the trial: a robot with something hidden, recorded, then diagnosed blind.

What is hidden stays on this side of the logs: the diagnosis is handed decoded logs, nothing else.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from spirob.diagnose.again import decided_again, joined, proposed
from spirob.diagnose.contest import contest
from spirob.diagnose.ladder import begun, climb
from spirob.diagnose.noise import complete
from spirob.diagnose.proof import Proof, models_of, proved, put_to_proof, to_prove
from spirob.diagnose.rungs import Search, Settings
from spirob.diagnose.verdict import Verdict, explained, foretold, judge
from spirob.effects import Effect, all_effects
from spirob.emulator.rig import HiddenSettings
from spirob.identify.fit import STEPS, fit
from spirob.identify.near import near
from spirob.identify.numbers import FITTED
from spirob.identify.problem import Problem, effort_rms
from spirob.identify.residual import Residual
from spirob.plant import Plant, Rig
from spirob.trial.answers import ANSWERS, TOGETHER
from spirob.trial.oracle import oracle
from spirob.trial.played import problems_of, recorded
from spirob.trial.strength import LEFT, SIZES, adjusted, beside, drawn_size, strength_of
from spirob.trial.visibility import left

TRIES = 5  # recordings of one robot, until its effect shows about as much as is wanted
SHOWN = (0.9 * SIZES[0], 1.25 * SIZES[1])  # % of the current's RMS: near enough


@dataclass(frozen=True)
class Case:
    """What is hidden in which robot.

    kind     of the emulator, "none", or two joined by "+"
    seed     draws, with the kind, the robot, the sizes of the effect and its strength
    without  diagnose once more with a library that lacks every right answer: it must not name
             another with confidence
    """

    kind: str
    seed: int
    without: bool = False

    @property
    def name(self) -> str:
        """Of its results' file."""
        return f"{self.kind.replace('+', '_and_')}-{self.seed}{'-without' * self.without}"

    @property
    def robot(self) -> int:
        """Seed of a robot of its own: cases that share one are not independent, as their rates'
        intervals take them to be."""
        return int(np.random.default_rng([self.seed, *self.kind.encode()]).integers(2**31))


def run(case: Case, settings: Settings | None = None) -> list[dict[str, Any]]:
    """Record, fit, diagnose, and compare with the oracle; one or two results as plain data."""
    settings = settings or Settings(intervals=False, always=False)
    library = list(all_effects().values())
    hidden, problems, base = _drawn(case, Plant(Rig(), library), settings)
    search = climb(problems, FITTED, library, {}, settings, known=base)
    first, asked, experiment = judge(search, problems, settings), search, ""
    if first.contested:
        asked, experiment = _asked_again(search, problems, first, hidden, case, settings)
    robot = hidden, case.robot
    best = oracle(problems, search, _counterparts(case), settings)
    about = {
        "kind": case.kind,
        "seed": case.seed,
        "robot": case.robot,
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


def _asked_again(
    search: Search,
    problems: Mapping[str, Residual],
    contested: Verdict,
    hidden: HiddenSettings,
    case: Case,
    settings: Settings,
) -> tuple[Search, str]:
    """The experiment that separates the rivals best, played on the same robot, and what it says."""
    proposals = proposed(search, contested, problems["validate"], settings)
    if not proposals:
        return search, ""
    best = proposals[0]
    known = joined(problems, recorded(hidden, case.robot, best.trials))
    asked = decided_again(contest(search, contested), problems, known, settings)
    return (search, f"{best.name}, set aside") if asked is None else (asked, best.name)


def _outcome(
    search: Search,
    robot: tuple[HiddenSettings, int],
    problems: Mapping[str, Residual],
    best: float,
    settings: Settings,
) -> dict[str, Any]:
    """What is said of one robot once a name was put to the proof, and how large the errors are.

    robot  plays the proof;  best  the oracle's error
    """
    verdict, proof = _proved(search, robot, problems, settings)
    named = [e.name() for e in search.rungs[-1].effects] if verdict.kind == "named" else []
    size = effort_rms(problems["heldout"])
    return {
        "verdict": verdict.kind,
        "named": named,
        "rivals": list(verdict.rivals),
        "probability": float(verdict.probability),
        "first": _first(search),
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


def _proved(
    search: Search,
    robot: tuple[HiddenSettings, int],
    problems: Mapping[str, Residual],
    settings: Settings,
) -> tuple[Verdict, Proof | None]:
    """The verdict, and what its name was worth on a trial of its own, played on the same robot."""
    verdict = judge(search, problems, settings)
    if verdict.kind != "named":
        return verdict, None
    experiments = to_prove(search, problems["validate"], settings)
    if not experiments:
        return verdict, None
    best = experiments[0]
    known = joined(problems, recorded(*robot, best.trials))
    proof = put_to_proof(best.name, models_of(search), problems, known, settings)
    return proved(verdict, proof), proof


def _drawn(
    case: Case, plant: Plant, settings: Settings
) -> tuple[HiddenSettings, Mapping[str, Residual], Search]:
    """What is hidden, as strong as is wanted; the robot's trials; the fit without any effect.

    Of two kinds each is as strong as it would be alone in the same robot.
    """
    kinds = case.kind.split("+")
    alone = [_alone(kind, case, plant, settings) for kind in kinds]
    if len(kinds) == 1:
        return alone[0]
    hidden = HiddenSettings("+".join(each.effect for each, _, _ in alone))
    problems = problems_of(recorded(hidden, case.robot), plant)
    return hidden, problems, _without_any(problems, settings)


def _alone(
    kind: str, case: Case, plant: Plant, settings: Settings
) -> tuple[HiddenSettings, Mapping[str, Residual], Search]:
    """One kind in a robot: how it shows depends on the robot, so where that is less or more than is
    ever drawn the robot is recorded again, at the strength that its logs ask for."""
    wanted = drawn_size(np.random.default_rng([case.seed, *kind.encode()]))
    strength = strength_of(kind, wanted)
    tries: list[tuple[float, float]] = []
    played = []
    while True:
        hidden = HiddenSettings("none" if kind == "none" else f"{kind}:{strength:.6g}")
        problems = problems_of(recorded(hidden, case.robot), plant)
        search = _without_any(problems, settings)
        tries.append((strength, beside(left(search.base, problems), LEFT)))
        played.append((_beyond(tries[-1][1]), hidden, problems, search))
        if kind == "none" or _beyond(tries[-1][1]) == 0.0 or len(tries) == TRIES:
            break
        strength, before = adjusted(tries, wanted), strength
        if strength == before:  # the strongest that is drawn
            break
    return min(played, key=lambda p: p[0])[1:]


def _without_any(problems: Mapping[str, Problem], settings: Settings) -> Search:
    """The numbers fitted without any effect, with wide differences first, then to the end."""
    train = near(problems["train"], {})
    found = fit(train, FITTED, {}, settings.scale, settings.patience, steps=STEPS[:1], exact=False)
    return begun(problems, FITTED, found.changes, settings, STEPS[-1:])


def _beyond(shown: float) -> float:
    """By what factor an effect shows less or more than is near enough, as a logarithm."""
    inside = min(max(shown, SHOWN[0]), SHOWN[1])
    return abs(math.log(max(shown, 1e-3) / inside))


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
