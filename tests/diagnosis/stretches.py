"""Synthetic stretches and a problem that holds them: what an atlas needs of a machine."""

from types import SimpleNamespace

import numpy as np

from spirob.identify.problem import Effort, Stretch

SECONDS = np.arange(0.0, 8.0, 0.01)
GEAR = 19.2


def stretch(trial="slow", channel="left motor", pace=1.0, **more):
    """A motor that winds in, stands and pays out, under a load that goes on changing."""
    phase = 2 * np.pi * pace * SECONDS / 8.0
    speed = 0.03 * np.sin(phase) * (np.abs(np.sin(phase)) > 0.2)
    position = np.cumsum(speed) * 0.01 + 1e-6 * SECONDS
    load = 0.4 + 0.2 * np.sin(1.7 * phase + 0.3)
    signals = {"angle": 60.0 * position * GEAR, "gear": GEAR} | more
    names = ("winding in", "paying out")
    return Stretch(trial, channel, SECONDS, position, speed, load, 1e-3, *names, **signals)


def problem(*pieces):
    return SimpleNamespace(
        stretches=lambda: list(pieces), block=50, effort=Effort("motor current", "A")
    )


def pair():
    """Two trials of either motor, played at different paces."""
    return [
        stretch(f"{channel} {pace}", channel, pace)
        for channel in ("left motor", "right motor")
        for pace in (1.0, 1.6)
    ]
