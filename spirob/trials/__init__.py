"""Trials: what is asked of each motor, and how it is played on a robot and logged.

trial.py        one trial in plain data, of a motor's mode, profile and limit; the one that winds
                the arm round a cylinder
profiles.py     reference profiles: what one is, and those there are
play.py         plays a trial on a robot, cycle by cycle, and hands everything to the log
simulation.py   trials without any robot: the model played at once, or as a robot
"""

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
