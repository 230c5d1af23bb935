"""Schedules and machines that the laws are tried on."""

import numpy as np

from spirob.control import CURRENT, VELOCITY, Gains, Schedule
from spirob.plant import Rig
from spirob.plant.rig import Winch

GEARED = Rig()
DIRECT = Rig(
    name="direct",
    winch=Winch(gear_ratio=1.0),
    gains=Gains(velocity=2.0, integral=12.0, newton_per_ampere=0.78, drag=0.25),
)
RIGS = {"geared": GEARED, "direct": DIRECT}


def seconds(duration):
    """Time of each 1 kHz cycle [s]."""
    return np.arange(round(duration * 1000)) * 1e-3


def rising(t, duration):
    """0 -> 1 within `duration`, without a jump in rate."""
    return 0.5 - 0.5 * np.cos(np.pi * np.clip(t / duration, 0.0, 1.0))


def currents(left, right, limit=5.0):
    """Commanded currents of both motors [A], arrays of one length or one array and a number."""
    reference = np.column_stack(np.broadcast_arrays(left, right)).astype(float)
    mode = np.array([CURRENT, CURRENT])
    return Schedule(mode, reference, np.zeros_like(reference), np.full(2, limit))


def winding(speed, right_current, duration):
    """The left tendon wound in at a constant speed [m/s], the right motor at a current [A]."""
    reference = np.tile([speed, right_current], (round(duration * 1000), 1)).astype(float)
    mode = np.array([VELOCITY, CURRENT])
    return Schedule(mode, reference, np.zeros_like(reference), np.full(2, 5.0))


def relative(got, wanted):
    """RMS difference over RMS of what is wanted."""
    return float(np.sqrt(np.mean((got - wanted) ** 2) / np.mean(wanted**2)))
