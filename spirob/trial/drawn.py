"""A robot whose hidden effect shows about as much as is wanted, recorded and fitted without it."""

import math
from collections.abc import Mapping

import numpy as np

from spirob.diagnosis.ladder import begun
from spirob.diagnosis.rungs import Search, Settings
from spirob.emulator.build import AS_DESIGNED
from spirob.emulator.rig import HiddenSettings
from spirob.identify.fit import STEPS, fit
from spirob.identify.near import near
from spirob.identify.numbers import FITTED
from spirob.identify.problem import Problem
from spirob.identify.residual import Residual
from spirob.plant import Plant
from spirob.trial.played import problems_of, recorded
from spirob.trial.strength import LEFT, RATIOS, adjusted, beside, drawn_size, sizes, strength_of
from spirob.trial.visibility import left

TRIES = 5  # recordings of one robot, until its effect shows about as much as is wanted
NEAR = (0.9, 1.25)  # of the least and of the most that is drawn: near enough


def drawn(
    kind: str,
    seed: int,
    robot: int,
    plant: Plant,
    settings: Settings,
    ratios: tuple[float, float] = RATIOS,
    build: str = AS_DESIGNED,
) -> tuple[HiddenSettings, Mapping[str, Residual], Search]:
    """What is hidden, as strong as is wanted; the robot's trials; the fit without any effect.

    Of two kinds each is as strong as it would be alone in the same robot.

    kind    one, or two joined by "+";  seed  draws the strength;  robot  its seed
    ratios  between which knowing the effect is to bring the error
    build   how the robot is built
    """
    alone = [_alone(each, seed, robot, plant, settings, ratios, build) for each in kind.split("+")]
    if len(alone) == 1:
        return alone[0]
    hidden = HiddenSettings("+".join(each.effect for each, _, _ in alone), build=build)
    problems = problems_of(recorded(hidden, robot), plant)
    return hidden, problems, _without_any(problems, settings)


def _alone(
    kind: str,
    seed: int,
    robot: int,
    plant: Plant,
    settings: Settings,
    ratios: tuple[float, float],
    build: str,
) -> tuple[HiddenSettings, Mapping[str, Residual], Search]:
    """One kind in a robot: how it shows depends on the robot, so where that is less or more than is
    ever drawn the robot is recorded again, at the strength that its logs ask for."""
    wanted = drawn_size(np.random.default_rng([seed, *kind.encode()]), ratios)
    strength = strength_of(kind, wanted)
    tries: list[tuple[float, float]] = []
    played = []
    while True:
        effect = "none" if kind == "none" else f"{kind}:{strength:.6g}"
        hidden = HiddenSettings(effect, build=build)
        problems = problems_of(recorded(hidden, robot), plant)
        search = _without_any(problems, settings)
        tries.append((strength, beside(left(search.base, problems), LEFT)))
        beyond = _beyond(tries[-1][1], sizes(ratios))
        played.append((beyond, hidden, problems, search))
        if kind == "none" or beyond == 0.0 or len(tries) == TRIES:
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


def _beyond(shown: float, asked: tuple[float, float]) -> float:
    """By what factor an effect shows less or more than is near enough, as a logarithm."""
    inside = min(max(shown, NEAR[0] * asked[0]), NEAR[1] * asked[1])
    return abs(math.log(max(shown, 1e-3) / inside))
