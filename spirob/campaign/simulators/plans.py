"""Where an axis is asked to be: tones, moves between places, sweeps, scans at constant speed."""

import numpy as np
from scipy.ndimage import gaussian_filter1d

from spirob.campaign.simulators.motion import FINE, Plan

TONES = 5
ROUNDED = 0.06  # periods of the fastest motion over which corners are rounded


def plan(
    motion: str,
    rng: np.random.Generator,
    seconds: float,
    stroke: float,
    fastest: float,
    warming: float = 0.0,
) -> Plan:
    """A plan of one log.

    motion   tones, moves, sweep, scan or one way;  stroke  [rad or m]
    fastest  [Hz], of the motion
    """
    t = np.arange(round(seconds * FINE)) / FINE
    make = {"tones": _tones, "moves": _moves, "sweep": _sweep, "scan": _scan, "one way": _one_way}
    path = _rounded(make[motion](rng, t, fastest), fastest)
    around = _rounded(_tones(rng, t, 0.7 * fastest), fastest)
    start = rng.uniform(-0.1, 0.1)
    return Plan(stroke * (path + start), around, warming)


def _rounded(path: np.ndarray, fastest: float) -> np.ndarray:
    return np.asarray(gaussian_filter1d(path, ROUNDED / fastest * FINE, mode="nearest"))


def _tones(rng: np.random.Generator, t: np.ndarray, fastest: float) -> np.ndarray:
    """A few tones, over a stroke of about one."""
    tones = rng.uniform(0.1, 1.0, TONES) * fastest
    tones[0] = fastest * rng.uniform(0.15, 0.35)
    weights = rng.uniform(0.5, 1.0, TONES) / (1 + 3 * tones / fastest)
    waves = weights[:, None] * np.sin(
        2 * np.pi * tones[:, None] * t + rng.uniform(0, 2 * np.pi, (TONES, 1))
    )
    path = waves.sum(axis=0)
    return np.asarray((path - path[0]) / max(float(np.ptp(path)), 1e-12))


def _moves(rng: np.random.Generator, t: np.ndarray, fastest: float) -> np.ndarray:
    """From place to place at speeds of their own, with short rests now and then."""
    corners, times = [0.0], [0.0]
    while times[-1] < t[-1]:
        goal = float(rng.uniform(-0.5, 0.5))
        speed = fastest * rng.uniform(0.5, 2.5)
        corners.append(goal)
        times.append(times[-1] + abs(goal - corners[-2]) / speed + 0.05 / fastest)
        if rng.uniform() < 0.3:
            corners.append(goal)
            times.append(times[-1] + rng.uniform(0.1, 0.3) / fastest)
    return np.interp(t, times, corners)


def _sweep(rng: np.random.Generator, t: np.ndarray, fastest: float) -> np.ndarray:
    """A tone that rises from slow to fast while it becomes smaller, on a slow wander."""
    slow = 0.15 * fastest
    rise = np.log(fastest / slow) / t[-1]
    cycles = slow * np.expm1(rise * t) / rise
    size = 0.5 * (slow / (slow * np.exp(rise * t))) ** 0.5
    wander = 0.3 * np.sin(2 * np.pi * 0.07 * fastest * t + rng.uniform(0, 2 * np.pi))
    path = size * np.sin(2 * np.pi * cycles) + wander
    return np.asarray(path - path[0])


def _scan(rng: np.random.Generator, t: np.ndarray, fastest: float) -> np.ndarray:
    """There and back at constant speeds, each pair at another one."""
    corners, times = [0.0], [0.0]
    while times[-1] < t[-1]:
        speed = fastest * float(np.exp(rng.uniform(np.log(0.15), np.log(2.0))))
        way = min(1.0, speed / fastest * 2.0)
        for goal in (way / 2, -way / 2):
            times.append(times[-1] + abs(goal - corners[-1]) / speed + 0.05 / fastest)
            corners.append(goal)
    return np.interp(t, times, corners)


def _one_way(rng: np.random.Generator, t: np.ndarray, fastest: float) -> np.ndarray:
    """Ahead all the time, at a speed that comes and goes."""
    tones = _tones(rng, t, fastest)
    speed = fastest * (0.6 + 0.9 * (tones - tones.min()))
    way = 1.0 if rng.uniform() < 0.5 else -1.0
    return way * np.cumsum(speed) / FINE
