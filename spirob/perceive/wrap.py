"""A wrap, read from a trial, in its parts: where it runs freely, where its current rises, its end.

The paper's filter delays the current by 49.5 ms, in which the tendon moves 2 mm; the displacement
goes through the same filter here, so that both belong to the same instant.  Levels are shares of
the rise from the free current to the plateau: friction and efficiency, in which a model and its
robot differ, scale and shift the current but leave these shares where they are.

A feature is one number of a wrap, with a name, a unit and a meaning.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from spirob.errors import DataError
from spirob.logs.trace import Trace, moving_average

WINDOW = 100  # samples, the paper's filter
FREE = (0.45, 0.75)  # of the end stroke: past the start-up, before the rise
PLATEAU = 0.1  # of the log, at its end


@dataclass(frozen=True)
class Wrap:
    """One wrap from the start of the motion on; arrays are (T,).

    name      of the trial
    period    between samples [s]
    current   as measured, positive winding in [A];  filtered  after the 100-sample mean [A]
    stroke    wound-in length since the start [m];  delayed  after the same mean as the current [m]
    velocity  [m/s]
    """

    name: str
    period: float
    current: np.ndarray
    filtered: np.ndarray
    stroke: np.ndarray
    delayed: np.ndarray
    velocity: np.ndarray

    @cached_property
    def plateau(self) -> float:
        """Current at which the wrap ends [A]."""
        return float(np.median(self.filtered[-self.tail :]))

    @cached_property
    def end_stroke(self) -> float:
        """Wound-in length at the end [m]."""
        return float(np.median(self.stroke[-self.tail :]))

    @property
    def tail(self) -> int:
        """How many samples at the end count as the plateau."""
        return max(WINDOW, int(PLATEAU * len(self.current)))

    @cached_property
    def free(self) -> slice:
        """Samples of free motion between start-up and rise."""
        first, last = (int(np.argmax(self.delayed >= k * self.end_stroke)) for k in FREE)
        return slice(first, max(last, first + 2))

    @cached_property
    def _free_line(self) -> np.ndarray:
        # A straight line, because friction along the tendon grows as the arm bends.
        return np.polyfit(self.delayed[self.free], self.filtered[self.free], 1)

    @cached_property
    def free_current(self) -> float:
        """Current that free motion would need at the end stroke [A]."""
        return float(np.polyval(self._free_line, self.end_stroke))

    @cached_property
    def free_speed(self) -> float:
        """Speed of the free motion [m/s]."""
        return float(np.median(self.velocity[self.free]))

    @property
    def rise(self) -> float:
        """From the free current to the plateau [A]."""
        return self.plateau - self.free_current

    @cached_property
    def share(self) -> np.ndarray:
        """Excess over the free current as a share of the rise: about 0 when free, 1 at the end."""
        return (self.filtered - np.polyval(self._free_line, self.delayed)) / self.rise

    def when(self, level: float) -> float:
        """Sample, with fraction, from which on the share stays above a level below 1."""
        settled = int(np.argmax(self.share >= 0.95)) if (self.share >= 0.95).any() else -1
        below = np.flatnonzero(self.share[self.free.start : settled] < level)
        if not len(below):
            return float(self.free.start)
        k = self.free.start + int(below[-1])
        step = self.share[k + 1] - self.share[k]
        return k + (float(np.clip((level - self.share[k]) / step, 0.0, 1.0)) if step > 0 else 0.0)

    def stroke_at(self, level: float) -> float:
        """Wound-in length where the share passes a level [m]."""
        return float(np.interp(self.when(level), np.arange(len(self.delayed)), self.delayed))


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


@dataclass(frozen=True)
class Feature:
    """A documented number of one wrap.

    kind  temporal, spectral or electromechanical;  measure  computes it
    """

    name: str
    kind: str
    unit: str
    meaning: str
    measure: Callable[[Wrap], float]


FEATURES: dict[str, Feature] = {}


def feature(unit: str, kind: str) -> Callable[[Callable[[Wrap], float]], Callable[[Wrap], float]]:
    """Enter a function of a `Wrap` in `FEATURES` by its name; its docstring is its meaning."""

    def enter(measure: Callable[[Wrap], float]) -> Callable[[Wrap], float]:
        name, meaning = measure.__name__, (measure.__doc__ or "").strip()
        if not meaning or name in FEATURES:
            raise TypeError(f"feature '{name}' needs a docstring and a name of its own")
        FEATURES[name] = Feature(name, kind, unit, meaning, measure)
        return measure

    return enter
