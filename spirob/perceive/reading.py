"""Reads a wrap from a trial, or says in a sentence why the trial is none."""

import numpy as np

from spirob.errors import DataError
from spirob.perceive.wrap import WINDOW, Wrap
from spirob.trace import Trace, moving_average

SHORTEST = 1000  # samples
STARTED = 5e-4  # m wound in: the motion has begun
LEAST_STROKE = 5e-3  # m
LEAST_RISE = 0.25  # of the plateau
STILL_MOVING = 0.2  # of the free speed


def read_wrap(trace: Trace, motor: str = "left") -> Wrap:
    """The wrap done by one motor, from its channels current, displacement and velocity.

    Raises TooShort, MissingChannel, and DataError naming the trial where a signal is not finite,
    the tendon hardly moves, still moves at the end, or its current does not rise.
    """
    names = [f"{motor}.{signal}" for signal in ("current", "displacement", "velocity")]
    for name in names:
        trace[name]  # a missing channel is told before its content is judged
    trace.require(SHORTEST, "a wrap")
    trace.require_finite(names)
    current, displacement, velocity = (np.asarray(trace[name], dtype=float) for name in names)
    stroke = displacement - displacement[0]
    if stroke.max() < LEAST_STROKE:
        raise DataError(
            f"{trace.name}: the {motor} tendon is wound in by only {1e3 * stroke.max():.2f} mm "
            f"at up to {np.abs(current).max():.2f} A, so nothing was wrapped"
        )
    start = int(np.argmax(stroke > STARTED))
    if len(trace) - start < SHORTEST:
        raise DataError(
            f"{trace.name}: the log ends {len(trace) - start} samples after the {motor} tendon "
            f"starts to move; a wrap needs at least {SHORTEST}"
        )
    # Filtered before it is cut, or the filter would start anew where the motion begins.
    smooth = [moving_average(x, WINDOW, trace.name)[start:] for x in (current, stroke)]
    wrap = Wrap(
        trace.name, trace.period, current[start:], smooth[0], stroke[start:], smooth[1],
        velocity[start:],
    )  # fmt: skip
    _require_rise(wrap, motor)
    return wrap


def _require_rise(wrap: Wrap, motor: str) -> None:
    where = f"{wrap.name}: the {motor} "
    last = float(np.median(wrap.velocity[-wrap.tail :]))
    if wrap.end_stroke < LEAST_STROKE:
        raise DataError(where + "tendon is paid out again before the log ends, so it ends no wrap")
    if last > STILL_MOVING * wrap.free_speed:
        raise DataError(
            where + f"tendon still moves at {1e3 * last:.1f} mm/s when the log ends, so nothing "
            "stopped it: no object was wrapped, or the trial is too short"
        )
    if wrap.rise >= LEAST_RISE * wrap.plateau:
        return
    early = float(np.median(wrap.filtered[wrap.free]))
    if wrap.plateau > 0.8 * early:
        raise DataError(
            where + f"current is at {early:.2f} A before any contact and {wrap.plateau:.2f} A at "
            "the end: it is saturated all along, so the contact cannot be seen"
        )
    raise DataError(
        where + f"current does not rise ({early:.2f} A while running, {wrap.plateau:.2f} A at the "
        "end), so nothing was wrapped"
    )
