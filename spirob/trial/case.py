"""One case of the trial: a robot with something hidden, recorded, then diagnosed blind.

What is hidden stays on this side of the logs: the diagnosis is handed decoded logs, nothing else.
"""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from spirob.bench import Trial, record
from spirob.diagnose.ladder import climb
from spirob.diagnose.rungs import ROLES, Search, Settings
from spirob.diagnose.verdict import judge
from spirob.effects import Effect, all_effects
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.emulator.robot import EmulatedRobot
from spirob.identify.measurement import Measurement
from spirob.identify.problem import Problem, effort_rms
from spirob.identify.residual import Residual
from spirob.logs import read_log
from spirob.logs.transmission import Transmission
from spirob.plant import Plant, Rig
from spirob.robot import Scene
from spirob.trial.answers import ANSWERS
from spirob.trial.bends import bends
from spirob.trial.oracle import oracle
from spirob.trial.strength import drawn_strength

NUMBERS = (
    "winch.efficiency",
    "motor.rotor_damping",
    "motor.rotor_inertia",
    "arm.base_stiffness",
    "arm.damping_time",
    "arm.bends_per_hinge",
    "tendon.stiffness",
    "winch.efficiency_difference",
    "motor.rotor_damping_difference",
)


@dataclass(frozen=True)
class Case:
    """What is hidden in which robot.

    kind     of the emulator, "none", or two joined by "+"
    seed     draws the robot, the sizes of the effect and its strength
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


def run(case: Case, settings: Settings | None = None) -> list[dict[str, Any]]:
    """Record, fit, diagnose, and compare with the oracle; one or two results as plain data."""
    settings = settings or Settings(intervals=False)
    hidden = _hidden(case)
    recorded = _recorded(hidden, case.seed)
    library = list(all_effects().values())
    problems = _problems(recorded, Plant(Rig(), library))
    search = climb(problems, NUMBERS, library, {}, settings)
    best = oracle(problems, search, _counterparts(case), settings)
    about = {
        "kind": case.kind,
        "seed": case.seed,
        "strengths": [float(strength) for _, strength in hidden.parts],
    }
    found = [{**about, "without": False, **_outcome(search, problems, best, settings)}]
    if case.without:
        kept = [e for e in library if e.name() not in _right_names(case)]
        blind = climb(problems, NUMBERS, kept, {}, settings, known=search)
        found.append({**about, "without": True, **_outcome(blind, problems, best, settings)})
    return found


def _outcome(
    search: Search, problems: Mapping[str, Problem], best: float, settings: Settings
) -> dict[str, Any]:
    """What was said of one robot, and how large the errors are; `best` is the oracle's."""
    verdict = judge(search, problems["validate"], settings)
    named = [e.name() for e in search.rungs[-1].effects] if verdict.kind == "named" else []
    size = effort_rms(problems["heldout"])
    return {
        "verdict": verdict.kind,
        "named": named,
        "rivals": list(verdict.rivals),
        "probability": float(verdict.probability),
        "first": _first(search),
        "heldout": {
            "base": search.rungs[0].scores["heldout"].rmse / size,
            "named": (search.rungs[-1] if named else search.rungs[0]).scores["heldout"].rmse / size,
            "oracle": best / size,
        },
    }


def _hidden(case: Case) -> HiddenSettings:
    kinds = case.kind.split("+")
    rng = np.random.default_rng([case.seed, *case.kind.encode()])
    strengths = [drawn_strength(kind, rng) for kind in kinds]
    text = "+".join(f"{k}:{s:.6g}" for k, s in zip(kinds, strengths, strict=True))
    return HiddenSettings("none" if case.kind == "none" else text)


def _recorded(hidden: HiddenSettings, seed: int) -> dict[str, list[Measurement]]:
    """Play all trials over the bus, and decode their logs."""
    rig = Rig()
    machine = EmulatedRig(
        gear_ratio=rig.winch.gear_ratio,
        winch_radius=rig.winch.radius,
        gravity=(rig.arm.gravity_x, rig.arm.gravity_y),
        current_bandwidth=rig.drive.bandwidth,
    )
    robot = EmulatedRobot(machine, hidden, seed)
    found: dict[str, list[Measurement]] = {role: [] for role in ROLES}
    try:
        with tempfile.TemporaryDirectory(prefix="spirob-trial-") as folder:
            for plain in bends():
                path = Path(folder) / f"{plain['name']}.mcap"
                _record(robot, Trial.from_plain(plain), path, rig)
                found[plain["role"]].append(Measurement.from_trace(read_log(path)))
    finally:
        robot.close()
    return found


def _record(robot: EmulatedRobot, trial: Trial, path: Path, rig: Rig) -> None:
    def prepare(scene: Scene) -> None:
        robot.prepare(scene, trial.name)

    record(
        trial,
        robot,
        path,
        transmission=Transmission(gear_ratio=rig.winch.gear_ratio, winch_radius=rig.winch.radius),
        gains=rig.gains,
        rig=rig.name,
        prepare=prepare,
    )


def _problems(recorded: dict[str, list[Measurement]], plant: Plant) -> dict[str, Residual]:
    return {role: Residual(plant, trials, workers=1) for role, trials in recorded.items()}


def _right_names(case: Case) -> set[str]:
    return {name for kind in case.kind.split("+") for name in ANSWERS[kind] if name}


def _counterparts(case: Case) -> Sequence[type[Effect]]:
    names = [ANSWERS[kind][0] for kind in case.kind.split("+")]
    return [all_effects()[name] for name in names if name]


def _first(search: Search) -> list[str]:
    """The candidates of the first round, best first."""
    first = search.rounds[0] if search.rounds else []
    return [e.name() for c in first for e in c.effects]
