"""Experiments: what a trial asks of each motor, and how it is played on a robot and logged."""

from spirob.bench.moves import Moves
from spirob.bench.play import guard, play, record
from spirob.bench.profile import PROFILES
from spirob.bench.profiles import Constant, Ramp, Shuttle, Steps, Triangle
from spirob.bench.tones import Multisine, Sine
from spirob.bench.trial import MotorPlan, Trial

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
