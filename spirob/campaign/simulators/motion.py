"""What a simulator is asked to play, what it gives back, and what all of them have in common.

An axis is asked to be on tones, moves between places, sweeps, scans at constant speed.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter1d

from spirob.campaign.simulators.hidden import Hidden

FINE = 5000.0  # Hz, of what a simulator gives back


@dataclass(frozen=True)
class Plan:
    """Where the axis is asked to be, (n,) at FINE; `around` what else moves, where anything does.

    warming  by how much friction in proportion to speed has changed at the end of a log
    ahead    torque that the controller adds, (n,); None: none.  A rigid axis alone knows it
    """

    wanted: np.ndarray
    around: np.ndarray
    warming: float = 0.0
    ahead: np.ndarray | None = None


@dataclass(frozen=True)
class Motion:
    """What an axis did, (n,) each at FINE, in SI.

    q       position that its sensor is at;  v  speed of the motor
    effort  in the unit of the machine's effort
    others  further joints by name
    known   of the effort, what the rig's description knows already, from position as it is read
    """

    q: np.ndarray
    v: np.ndarray
    effort: np.ndarray
    others: dict[str, np.ndarray] = field(default_factory=dict)
    known: Callable[[np.ndarray], np.ndarray] | None = None


@dataclass(frozen=True)
class Machine:
    """A machine as it was drawn.

    rig       servo, direct drive, slide, joint, two masses, bench
    angular   whether it turns
    inertia, viscous  of the whole axis, in its own units
    effort    current, torque, force or voltage;  constant  torque for one unit of it
    origin    measured, command or sensor
    numbers   the simulator's own
    stroke, fastest   of the motion [rad or m], [Hz]
    turn      rad of the motor for one unit of position
    motions   kinds of motion that it plays
    described further keys of its description;  files  beside it, name -> text
    """

    rig: str
    angular: bool
    inertia: float
    viscous: float
    effort: str
    constant: float
    origin: str
    numbers: Any
    stroke: float
    fastest: float
    turn: float = 1.0
    motions: tuple[str, ...] = ("tones", "moves", "sweep")
    described: dict[str, Any] = field(default_factory=dict)
    files: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Simulator:
    """A way to simulate axes.

    kinds     that it can hide
    bristles  whether its dry friction always turns round over a short way
    draw      (rng, kinds that will be hidden, fastest motion [Hz]) -> a machine
    play      (machine, what is hidden, what to play) -> its motion
    """

    name: str
    kinds: frozenset[str]
    bristles: bool
    draw: Callable[[np.random.Generator, frozenset[str], float], Machine]
    play: Callable[[Machine, Hidden, Plan], Motion]


PASSIVE = frozenset(
    {
        "none",
        "coulomb_friction",
        "stribeck_friction",
        "presliding_friction",
        "asymmetric_viscous_friction",
        "quadratic_drag",
        "cogging",
        "parallel_spring",
        "constant_force",
        "current_offset",
        "current_gain",
        "current_lag",
        "feedback_latency",
        "encoder_eccentricity",
        "position_viscosity",
        "drifting_friction",
        "power_friction",
        "progressive_spring",
        "tight_spot",
        "hysteretic_spring",
        "chirped_magnets",
        "stick_one_way",
        "loose_screw",
    }
)
DRIVEN = PASSIVE | {
    "load_dependent_friction",
    "direction_dependent_efficiency",
    "torque_ripple",
    "tip_payload",
    "driver_dead_band",
    "torque_constant_saturation",
    "winding_heating",
    "speed_efficiency",
}
MOTOR = {  # kinds of the motor or its sensor: invisible to a sensor behind it
    "direction_dependent_efficiency",
    "torque_ripple",
    "driver_dead_band",
    "torque_constant_saturation",
    "winding_heating",
    "speed_efficiency",
    "current_offset",
    "current_gain",
    "current_lag",
}


def drawn_effort(
    rng: np.random.Generator, kinds: frozenset[str], angular: bool, voltage: bool
) -> tuple[str, float, str]:
    """What the effort is, torque or force for one unit of it, and where it comes from."""
    plain = "torque" if angular else "force"
    choices = [plain, "current", *(["voltage"] if voltage and not kinds & MOTOR else [])]
    chosen = str(rng.choice(choices))
    constant = 1.0 if chosen == plain else float(np.exp(rng.uniform(np.log(0.1), np.log(5.0))))
    return chosen, constant, "command" if "driver_dead_band" in kinds else "measured"


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Drawn evenly in the logarithm."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


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
