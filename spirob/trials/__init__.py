"""Experiments: what a trial asks of each motor, and how it is played on a robot and logged."""

from spirob.trials.play import guard, play, record
from spirob.trials.profiles import (
    PROFILES,
    Constant,
    Moves,
    Multisine,
    Ramp,
    Shuttle,
    Sine,
    Steps,
    Triangle,
)
from spirob.trials.trial import MotorPlan, Trial

__all__ = [
    "PROFILES",
    "Constant",
    "MotorPlan",
    "Moves",
    "Multisine",
    "Ramp",
    "Shuttle",
    "Sine",
    "Steps",
    "Trial",
    "Triangle",
    "guard",
    "play",
    "record",
]
