"""Which trial would tell two explanations apart?

Both models play every trial of a short list, each on either side, and the one on which their
signals differ most, relative to the effort there, is proposed: what other differences between
machine and model leave grows with the effort.  What it is worth is then for the robot to say.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spirob.errors import SimulationError
from spirob.geometry import PUBLISHED
from spirob.identify.measurement import Measurement
from spirob.identify.problem import Effort, effort_rms, rms
from spirob.identify.residual import Residual
from spirob.plant.tendon import stroke
from spirob.robot import MOTORS
from spirob.trials.simulation import simulate
from spirob.trials.trial import Trial

LIMIT = 5.0  # A
DECIDE = "decide", "explanations differ"
PROVE = "make sure", "models with and without what is named differ"

# name, (duration [s], length [m]) of the moves of one motor, and what the other's current does
Played = tuple[str, tuple[tuple[float, float], ...], dict[str, Any]]

TRIALS: tuple[Played, ...] = (
    ("slow crawl", ((0.1, 0.0), (5.0, 0.02)), {"kind": "constant", "value": 0.8}),
    (
        "fast moves",
        ((0.1, 0.0), (0.4, 0.012), (0.4, 0.004), (0.4, 0.014), (0.4, 0.005)),
        {"kind": "constant", "value": 0.8},
    ),
    (
        "short reversals",
        ((0.1, 0.0), (0.8, 0.014), (0.3, 0.011), (0.3, 0.014), (0.3, 0.011), (0.4, 0.013)),
        {"kind": "constant", "value": 0.8},
    ),
    (
        "light load",
        ((0.1, 0.0), (1.2, 0.025), (0.3, 0.025), (0.8, 0.014)),
        {"kind": "constant", "value": 0.35},
    ),
    (
        "second load",
        ((0.1, 0.0), (1.2, 0.02), (0.3, 0.02), (0.8, 0.011)),
        {"kind": "constant", "value": 2.0},
    ),
    (
        "hot run",
        ((0.1, 0.0), (0.8, 0.012), (3.0, 0.012), (0.8, 0.006)),
        {"kind": "constant", "value": 3.0},
    ),
    (
        "hold",
        ((0.1, 0.0), (1.2, 0.03), (3.0, 0.03), (0.8, 0.02)),
        {"kind": "constant", "value": 0.7},
    ),
    (
        "load dropped",
        ((0.1, 0.0), (1.0, 0.015), (1.9, 0.015)),
        {"kind": "ramp", "start": 1.4, "end": 0.2, "begins": 1.6, "ends": 2.0},
    ),
    (
        "load up and down",
        ((0.1, 0.0), (1.0, 0.015), (2.9, 0.015)),
        {"kind": "triangle", "low": 0.4, "high": 1.6, "period": 2.0},
    ),
    ("deep bend", ((0.1, 0.0), (2.4, 0.07), (0.8, 0.055)), {"kind": "constant", "value": 0.65}),
)

ROLES = ("train", "validate")  # of the trial in which the left motor moves, and of the other


@dataclass(frozen=True)
class Proposal:
    """An experiment, and by how much two explanations differ on it.

    trials      on either side, as plain data
    difference  RMS of what the residual compares, in its unit;  share  of the effort's RMS there
    proves      the explanations are the models with a name and without
    """

    name: str
    trials: tuple[dict[str, Any], ...]
    difference: float
    share: float
    proves: bool = False


def propose(
    problem: Residual, one: Mapping[str, float], other: Mapping[str, float]
) -> list[Proposal]:
    """All experiments, that in whose effort the models with these numbers differ most first.

    An experiment that one of the models cannot play to its end is left out.
    """
    every = [proposal(problem, p[0], on_either_side(p, ROLES), one, other) for p in TRIALS]
    return sorted([p for p in every if p is not None], key=lambda p: -p.share)


def on_either_side(played: Played, roles: Sequence[str]) -> tuple[dict[str, Any], ...]:
    """The trial in which the left motor moves and that in which the right one does, as plain data.

    roles  of the two
    """
    name, moves, load = played
    return tuple(
        bend(f"{name.replace(' ', '_')}_{motor}", role, motor, moves, load)
        for motor, role in zip(MOTORS, roles, strict=True)
    )


def proposal(
    problem: Residual,
    name: str,
    trials: tuple[dict[str, Any], ...],
    one: Mapping[str, float],
    other: Mapping[str, float],
) -> Proposal | None:
    """What an experiment of these trials would show; None where a model cannot play it.

    trials  with the lengths of the published arm, which are taken in proportion to its stroke
    """
    by = stroke(problem.plant.rig.geometry.arm()) / stroke(PUBLISHED.arm())
    trials = tuple(_sized(trial, by) for trial in trials)
    try:
        apart = [_difference(problem, trial, one, other) for trial in trials]
    except SimulationError:
        return None
    difference, effort = np.sqrt(np.mean(np.square(apart), axis=0))
    return Proposal(name, trials, float(difference), float(difference / effort))


def told(proposals: Sequence[Proposal], effort: Effort) -> str:
    """What to play next and what it is worth, in a line; empty where nothing can be played."""
    if not proposals:
        return ""
    first, *others = proposals
    why, who = PROVE if first.proves else DECIDE
    names = ", ".join(trial["name"] for trial in first.trials)
    line = f"To {why}: play '{first.name}' ({names}); the {who} by {_worth(first, effort)} there"
    if others:
        line += f" (on '{others[0].name}', the next best, by {_worth(others[0], effort)})"
    return f"{line}."


def _worth(proposal: Proposal, effort: Effort) -> str:
    """A difference in the effort's unit, and its share of the effort there: that is what counts."""
    return f"{effort.shown(proposal.difference)}, {proposal.share:.1%} of the {effort.name},"


def bend(
    name: str,
    role: str,
    motor: str,
    moves: Sequence[tuple[float, float]],
    load: Mapping[str, Any],
    limit: float = LIMIT,
) -> dict[str, Any]:
    """A trial in which one motor moves and the other pulls against it, as plain data.

    moves  (duration [s], length [m]);  load  profile of the other's current [A]
    limit  of either command [A]
    """
    other = "right" if motor == "left" else "left"
    follow = {"kind": "moves", "waypoints": [list(move) for move in moves]}
    pull = {"blend": 0.2, **load}
    return {
        "name": name,
        "role": role,
        "duration": sum(lasts for lasts, _ in moves),
        "motors": {
            motor: {"mode": "displacement", "current_limit": limit, "profile": follow},
            other: {"mode": "current", "current_limit": limit, "profile": pull},
        },
    }


def _sized(trial: Mapping[str, Any], by: float) -> dict[str, Any]:
    """A trial with the lengths of its moves so many times as large."""
    motors = {}
    for motor, plan in trial["motors"].items():
        profile = dict(plan["profile"])
        if profile["kind"] == "moves":
            profile["waypoints"] = [[lasts, by * x] for lasts, x in profile["waypoints"]]
        motors[motor] = {**plan, "profile": profile}
    return {**trial, "motors": motors}


def _difference(
    problem: Residual, plain: dict[str, Any], one: Mapping[str, float], other: Mapping[str, float]
) -> tuple[float, float]:
    """RMS of what the models differ by, and of the effort."""
    played = Measurement.from_trace(simulate(problem.plant, Trial.from_plain(plain), one))
    there = replace(problem, trials=[played])
    return rms(there(other)), effort_rms(there)
