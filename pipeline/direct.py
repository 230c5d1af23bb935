"""What the trial before a passive experiment tells of a robot on direct drive, for its models.

Its loop's own numbers (`spirob.experiments.host_loop`), and how its hinges lose: behind a gear the
arm swings too slowly for that to show, so that a fit of the geared machine leaves it open.  On
direct drive both tendons shake the arm, and

    τ_d = argmin Σ (v_robot - v_model(τ_d))²

over both tendons' speeds.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from pipeline.schema import Config
from pipeline.sides import Models, model_side, robot_side
from spirob.experiments import Experiment, Play, Side

DAMPING = "arm.damping_time"
REACH = (2e-3, 0.2)  # s
CLOSE = 0.02  # of the number


def informed(
    config: Config, hidden: Mapping[str, Any], experiment: Experiment, models: Models, logs: Path
) -> tuple[Experiment, Models]:
    """Experiment and models with what the robot's trial has told; hardware is not driven."""
    first = experiment.before()
    if first is None or config.robot.kind == "can":
        return experiment, models
    side = robot_side(config, hidden, first, logs / f"{first.name}.mcap")
    experiment = experiment.informed(side)
    again = experiment.before() or first
    return experiment, {name: damped(config, again, m, side) for name, m in models.items()}


def damped(config: Config, play: Play, model: Mapping[str, Any], robot: Side) -> dict[str, Any]:
    """A model with the damping under which its tendons move as the robot's in this trial."""

    def moved(log_time: float) -> dict[str, Any]:
        return {**model, "changes": {**model["changes"], DAMPING: float(np.exp(log_time))}}

    def apart(log_time: float) -> float:
        other = model_side(config, play, moved(log_time))
        return float(np.mean((robot.velocity - other.velocity) ** 2))

    bounds = (np.log(REACH[0]), np.log(REACH[1]))
    found = minimize_scalar(apart, bounds=bounds, method="bounded", options={"xatol": CLOSE})
    return moved(float(found.x))
