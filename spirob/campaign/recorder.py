"""What a log holds of a motion: rate, delay, counts, wraps, jitter, noise, units.

And how much of the effort is hidden in it: what numbers of the description cannot take up.  The
effort is fitted by acceleration and speed of the motion as it is reported, beside what the
description knows of it, without noise and without delay; all pass the filter that a log of this
rate allows.  What is left, over the effort, is how much is hidden.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from spirob.campaign.simulators.hidden import Hidden
from spirob.campaign.simulators.motion import FINE, Machine, Motion

RATES = (20.0, 30.0, 60.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0)  # Hz
COUNTS = (1024, 4096, 16384, 65536)  # of an encoder in a turn, or over a stroke
PLACES = {True: ("rad", "deg", "turn", "tick"), False: ("m", "mm", "tick")}
UNITS = {"torque": ("N·m", "mN·m"), "force": ("N",), "current": ("A", "mA"), "voltage": ("V",)}
SI = {"rad": 1.0, "deg": np.pi / 180, "turn": 2 * np.pi, "m": 1.0, "mm": 1e-3}
SI |= {"N·m": 1.0, "mN·m": 1e-3, "N": 1.0, "A": 1.0, "mA": 1e-3, "V": 1.0}
WRAPPED = 0.2  # of a turn in a sample at most, where a position wraps
AHEAD = 0.05  # s, by which the effort may lead or trail
WHITE = (0.002, 0.2)  # noise of an effort over its RMS, as published logs of currents have it
SLOW = (0.005, 0.1)
FASTEST, SAMPLES = 20.0, 16.0  # Hz, and samples in a period, of what a log shows
EDGE = 0.5  # s at both ends, where the filter has no neighbours


@dataclass(frozen=True)
class Recorder:
    """How the logs of one machine were made.

    rate    [Hz];  seconds  of each log;  logs  in all, the last of which is held out
    delay   by which the effort trails the motion [s]
    counts  of the position in a turn, or over the stroke;  wraps  whether a turn begins again
    jitter  of the samples' times, in periods;  stamped  whether the stamps tell it
    white, slow  noise of the effort over its RMS;  pace  of the slow noise [s]
    place, unit  of position and effort
    """

    rate: float
    seconds: float
    logs: int
    delay: float
    counts: int
    wraps: bool
    jitter: float
    stamped: bool
    white: float
    slow: float
    pace: float
    place: str
    unit: str


def length_of(rate: float, rng: np.random.Generator) -> float:
    """Seconds of a log: slow ones are longer."""
    low, high = (30.0, 60.0) if rate < 100.0 else (8.0, 20.0) if rate < 1000.0 else (6.0, 12.0)
    return float(rng.uniform(low, high))


def drawn_recorder(
    rng: np.random.Generator, machine: Machine, rate: float, seconds: float, speed: float
) -> Recorder:
    """A recorder for a machine that moves as fast as `speed`."""
    most = float(rng.choice([min(1 / rate, 5e-3), 0.01, AHEAD], p=[0.4, 0.4, 0.2]))
    delay = most * rng.uniform(-1, 1)
    place = str(rng.choice(PLACES[machine.angular]))
    slow_enough = speed / rate < WRAPPED * 2 * np.pi
    return Recorder(
        rate,
        seconds,
        int(rng.integers(2, 5)),
        float(delay),
        int(rng.choice(COUNTS)),
        bool(machine.angular and machine.stroke > 4.0 and slow_enough and rng.uniform() < 0.5),
        float(rng.choice([0.0, 0.0, 0.0, 0.1, 0.2])),
        bool(rng.uniform() < 0.5),
        even(rng, WHITE),
        float(rng.choice([0.0, even(rng, SLOW)])),
        float(rng.uniform(0.05, 0.5)),
        place,
        str(rng.choice(UNITS[machine.effort])),
    )


def even(rng: np.random.Generator, span: tuple[float, float]) -> float:
    """Drawn evenly in the logarithm."""
    return float(np.exp(rng.uniform(*np.log(span))))


def reported(motion: Motion, machine: Machine, hidden: Hidden) -> Motion:
    """The motion as the machine's sensors tell it, before anything is counted or sampled."""
    n = len(motion.q)
    t = np.arange(n) / FINE
    angle = machine.turn * motion.q
    wrong = np.sin(angle) + hidden.eccentric_second * np.sin(2 * angle + 1.0)
    q = motion.q + hidden.eccentric * wrong
    if hidden.latency > 0.0:
        q = np.interp(t - hidden.latency, t, q)
    effort = motion.effort * (1.0 + hidden.gain) + hidden.offset / machine.constant
    if hidden.lag > 0.0:
        keep = np.exp(-1.0 / (FINE * hidden.lag))
        effort, _ = scipy.signal.lfilter([1.0 - keep], [1.0, -keep], effort, zi=[keep * effort[0]])
    return Motion(q, motion.v, np.asarray(effort), motion.others, motion.known)


def columns(
    motion: Motion,
    machine: Machine,
    recorder: Recorder,
    rng: np.random.Generator,
    size: float | None = None,
) -> dict[str, np.ndarray]:
    """The columns of a log of a reported motion, in the log's units.

    size  of the effort by which its noise is measured; its own RMS where none is given
    """
    fine = np.arange(len(motion.q)) / FINE
    ends = AHEAD + 1.0 / recorder.rate
    stamps = np.arange(ends, fine[-1] - ends, 1.0 / recorder.rate)
    taken = stamps + recorder.jitter / recorder.rate * rng.uniform(-0.5, 0.5, len(stamps))
    effort = np.interp(taken - recorder.delay, fine, motion.effort)
    size = float(np.sqrt(np.mean(effort**2))) if size is None else size
    effort = effort + recorder.white * size * rng.standard_normal(len(effort))
    effort = effort + recorder.slow * size * _slow(rng, len(effort), recorder)
    found = {
        "t": (taken if recorder.stamped else stamps) - stamps[0],
        "q": _counted(np.interp(taken, fine, motion.q), machine, recorder),
        "u": effort / SI[recorder.unit],
    }
    return found | {name: np.interp(taken, fine, q) for name, q in motion.others.items()}


def _slow(rng: np.random.Generator, n: int, recorder: Recorder) -> np.ndarray:
    """Noise that wanders, of deviation 1."""
    keep = np.exp(-1.0 / (recorder.rate * recorder.pace))
    start = rng.standard_normal()
    drawn = np.sqrt(1 - keep**2) * rng.standard_normal(n)
    return np.asarray(scipy.signal.lfilter([1.0], [1.0, -keep], drawn, zi=[keep * start])[0])


def _counted(q: np.ndarray, machine: Machine, recorder: Recorder) -> np.ndarray:
    whole = 2 * np.pi if machine.angular else machine.stroke
    ticks = np.round(q / whole * recorder.counts)
    if recorder.wraps:
        ticks = np.mod(ticks, recorder.counts)
    if recorder.place == "tick":
        return np.asarray(ticks)
    return np.asarray(ticks / recorder.counts * whole / SI[recorder.place])


def description(
    machine: Machine, recorder: Recorder, delay_known: bool, rng: np.random.Generator
) -> dict[str, Any]:
    """The rig as its owner would describe it: numbers to fit are up to three times off."""
    described = dict(machine.described)
    position: dict[str, Any] = {"column": "q", "unit": recorder.place}
    if recorder.place == "tick":
        per = "per_turn" if machine.angular else "per_metre"
        position[per] = recorder.counts / (1.0 if machine.angular else machine.stroke)
    if "side" in described:
        position["side"] = described.pop("side")
    known = dict(described.pop("known", {}))
    if delay_known:
        known["delay"] = recorder.delay
    scale = 1.0 if "scale" in known else machine.constant
    numbers = {"inertia": machine.inertia / scale, "viscous": machine.viscous / scale}
    fit = {}
    for name, value in numbers.items():
        if name not in known:
            nominal = float(f"{value * 3.0 ** rng.uniform(-1, 1):.3g}")
            low = 0.0 if name == "viscous" else nominal / 100
            fit[name] = {"nominal": nominal, "low": low, "high": nominal * 100}
    rig: dict[str, Any] = {
        "name": machine.rig,
        "time": {"column": "t", "unit": "s"},
        "position": position,
        "effort": {
            "column": "u",
            "unit": recorder.unit,
            "kind": machine.effort,
            "origin": machine.origin,
        },
        "fit": fit,
        **described,
    }
    rig |= {"known": known} if known else {}
    return rig | ({"gear": machine.turn} if machine.turn != 1.0 else {})


def share(motions: Sequence[Motion], rate: float) -> float:
    """Share of the effort's RMS that is hidden in logs of this rate [Hz]."""
    rows = [_rows(m, rate) for m in motions]
    design, effort, whole = (np.concatenate(parts) for parts in zip(*rows, strict=True))
    size = np.linalg.norm(design, axis=0) + 1e-300
    found, *_ = np.linalg.lstsq(design / size, effort, rcond=None)
    left = effort - design / size @ found
    return float(np.sqrt(np.mean(left**2) / max(np.mean(whole**2), 1e-300)))


def _rows(motion: Motion, rate: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Acceleration and speed, (n, 2); the effort beside what is known, and all of it, (n,)."""
    sos = scipy.signal.butter(4, min(FASTEST, rate / SAMPLES), fs=FINE, output="sos")

    def smooth(values: np.ndarray) -> np.ndarray:
        return np.asarray(scipy.signal.sosfiltfilt(sos, values))

    q, whole = smooth(motion.q), smooth(motion.effort)
    v = np.gradient(q, 1 / FINE)
    effort = whole if motion.known is None else whole - smooth(motion.known(motion.q))
    every = max(1, int(FINE / (8 * FASTEST)))
    kept = slice(int(EDGE * FINE), len(q) - int(EDGE * FINE), every)
    design = np.column_stack([np.gradient(v, 1 / FINE), v])
    return design[kept], effort[kept], whole[kept]
