"""Features of a wrap, and trials as a table of them, one row for each wrap.

Electromechanical: current over displacement, how far the tendon comes and what it costs.  Strokes
are read at shares of the current's rise, and work is divided by the rise, so that neither friction
nor the efficiency of the gear scales them.  Two obvious numbers are no features: the work of the
whole wrap, and current over displacement against that of free motion.  In simulation they move by
0.5 and 1.8 of their range when rotor damping trebles, the strokes by 0.02.

Temporal: when things happen, counted from the start of the motion, in free-running seconds.  A
time is multiplied by the free speed and divided by the nominal one: a trial that runs 5 % faster
reaches the same stroke 5 % earlier, and its clock should not tell that as another size.

Spectral: the current over frequency, in a window that all wraps share.  The window begins with the
motion and is long enough for the smallest object; the current's trend, a straight line, is removed,
and what remains is divided by its energy.
"""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import pandas as pd
import scipy

from spirob.errors import ConfigError, DataError
from spirob.logs.trace import Trace
from spirob.perceive.wrap import FEATURES, Feature, Wrap, feature, read_wrap


@feature("m", "electromechanical")
def onset_stroke(wrap: Wrap) -> float:
    """Wound-in length at a tenth of the current's rise: the arm closes round the object."""
    return wrap.stroke_at(0.1)


@feature("m", "electromechanical")
def knee_stroke(wrap: Wrap) -> float:
    """Wound-in length at a quarter of the current's rise."""
    return wrap.stroke_at(0.25)


@feature("m", "electromechanical")
def half_rise_stroke(wrap: Wrap) -> float:
    """Wound-in length at half of the current's rise."""
    return wrap.stroke_at(0.5)


@feature("m", "electromechanical")
def late_stroke(wrap: Wrap) -> float:
    """Wound-in length at three quarters of the current's rise."""
    return wrap.stroke_at(0.75)


@feature("m", "electromechanical")
def end_stroke(wrap: Wrap) -> float:
    """Wound-in length at the plateau, the current that ends the wrap."""
    return wrap.end_stroke


@feature("m", "electromechanical")
def rise_stroke(wrap: Wrap) -> float:
    """Wound-in length between a tenth and three quarters of the rise; little at a stiff one."""
    return wrap.stroke_at(0.75) - wrap.stroke_at(0.1)


@feature("m", "electromechanical")
def contact_work(wrap: Wrap) -> float:
    """Work ∫(i - i_free) dx from free motion to the end, over the current's rise."""
    part = slice(wrap.free.start, None)
    return float(np.trapezoid(wrap.share[part], wrap.delayed[part]))


@feature("1/m", "electromechanical")
def rise_slope(wrap: Wrap) -> float:
    """Slope di/dx from a tenth to half of the rise over the whole rise, by least squares."""
    first, last = int(wrap.when(0.1)), int(wrap.when(0.5)) + 2
    share, stroke = wrap.share[first:last], wrap.delayed[first:last]
    # dx over di and not its inverse: a wrap that tightens without moving has no di/dx.
    softness = float(np.polyfit(share, stroke, 1)[0])
    return 1.0 / max(softness, 1e-4)


@feature("1/m", "electromechanical")
def current_over_stroke(wrap: Wrap) -> float:
    """Share of the current's rise over displacement, mean of the upper half of the rise."""
    first, last = int(wrap.when(0.5)) + 1, int(wrap.when(0.9)) + 2
    return float(np.mean(wrap.share[first:last] / wrap.delayed[first:last]))


@feature("1", "electromechanical")
def relative_rise(wrap: Wrap) -> float:
    """Wound-in length from a tenth of the rise to the end, over the whole end stroke."""
    return 1.0 - wrap.stroke_at(0.1) / wrap.end_stroke


NOMINAL_SPEED = 0.045  # m/s


def _seconds(wrap: Wrap, samples: float) -> float:
    return samples * wrap.period * wrap.free_speed / NOMINAL_SPEED


@feature("s", "temporal")
def onset_time(wrap: Wrap) -> float:
    """Time until a tenth of the current's rise."""
    return _seconds(wrap, wrap.when(0.1))


@feature("s", "temporal")
def half_rise_time(wrap: Wrap) -> float:
    """Time until half of the current's rise."""
    return _seconds(wrap, wrap.when(0.5))


@feature("s", "temporal")
def rise_time(wrap: Wrap) -> float:
    """Time from a tenth to nine tenths of the current's rise."""
    return _seconds(wrap, wrap.when(0.9) - wrap.when(0.1))


@feature("s", "temporal")
def stall_time(wrap: Wrap) -> float:
    """Time until the velocity stays below half of the free velocity."""
    fast = np.flatnonzero(wrap.velocity >= 0.5 * wrap.free_speed)
    return _seconds(wrap, float(fast[-1] + 1) if len(fast) else 0.0)


SECONDS = 2.5  # of free motion at the nominal speed


def _spectrum(wrap: Wrap) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz] and shares of energy of the detrended current, without the mean."""
    length = min(int(SECONDS / wrap.period), len(wrap.current))
    level = np.clip(wrap.current[:length], 0.0, wrap.plateau) / wrap.plateau
    window = scipy.signal.windows.hann(length, sym=False)
    power = np.abs(np.fft.rfft(scipy.signal.detrend(level) * window)) ** 2
    power[0] = 0.0
    return np.fft.rfftfreq(length, wrap.period), power / max(power.sum(), 1e-30)


def _band(wrap: Wrap, low: float, high: float) -> float:
    frequency, power = _spectrum(wrap)
    return float(power[(frequency >= low) & (frequency < high)].sum())


@feature("1", "spectral")
def slow_share(wrap: Wrap) -> float:
    """Share of the current's energy below 0.6 Hz: how long the plateau lasts in the window."""
    return _band(wrap, 0.0, 0.6)


@feature("1", "spectral")
def middle_share(wrap: Wrap) -> float:
    """Share of the current's energy from 0.6 to 2 Hz: the rise."""
    return _band(wrap, 0.6, 2.0)


@feature("1", "spectral")
def fast_share(wrap: Wrap) -> float:
    """Share of the current's energy from 2 to 10 Hz: steps of single units meeting the object."""
    return _band(wrap, 2.0, 10.0)


@feature("Hz", "spectral")
def spectral_centroid(wrap: Wrap) -> float:
    """Mean frequency of the current up to 10 Hz, weighted by energy."""
    frequency, power = _spectrum(wrap)
    low = frequency < 10.0
    return float(frequency[low] @ power[low] / power[low].sum())


@feature("s", "spectral")
def phase_delay(wrap: Wrap) -> float:
    """Delay of the current's rise after the start, told by the phase of its rate's lowest line."""
    length = min(int(SECONDS / wrap.period), len(wrap.share))
    level = np.clip(wrap.share[:length], 0.0, 1.0)
    level[: wrap.free.start] = 0.0  # the start-up is no rise
    rate = np.diff(level, prepend=0.0)
    # Half a turn over the window, so that every delay within it has a phase of its own.
    turn = np.pi * np.arange(length) / length
    phase = np.angle(rate @ np.exp(1j * turn))
    return float(phase / np.pi * length * wrap.period * wrap.free_speed / NOMINAL_SPEED)


def extract(
    trace: Trace, motor: str = "left", names: Sequence[str] | None = None
) -> dict[str, float]:
    """Features of one wrap by name, in the units that `FEATURES` states.

    names  which ones, in this order; all where None
    Raises ConfigError on an unknown feature and what `read_wrap` raises; never returns a NaN.
    """
    for name in names or ():
        if name not in FEATURES:
            raise ConfigError(f"no feature '{name}'; known: {', '.join(FEATURES)}")
    wrap = read_wrap(trace, motor)
    values = {name: FEATURES[name].measure(wrap) for name in names or FEATURES}
    for name, value in values.items():
        if not abs(value) < float("inf"):
            raise DataError(f"{trace.name}: feature '{name}' is {value}, so this is no wrap")
    return values


def table(traces: Iterable[Trace]) -> pd.DataFrame:
    """Features of many wraps, indexed by trial, with the true diameter [m] as last column.

    The truth is read from the scene in `meta`.  Raises DataError where a trial has no cylinder
    and what `extract` raises.
    """
    rows = {}
    for trace in traces:
        if trace.name in rows:
            raise DataError(f"two wraps have the name '{trace.name}'")
        rows[trace.name] = {**extract(trace), "diameter": true_diameter(trace)}
    out = pd.DataFrame.from_dict(rows, orient="index")
    out.index.name = "trial"
    return out


def true_diameter(trace: Trace) -> float:
    """Diameter [m] of the cylinder that the log says stood there; DataError where it says none."""
    scene = trace.meta.get("scene")
    cylinder = scene.get("cylinder") if isinstance(scene, Mapping) else None
    if not isinstance(cylinder, Mapping) or "diameter" not in cylinder:
        raise DataError(f"{trace.name}: its scene has no cylinder, so the true diameter is unknown")
    return float(cylinder["diameter"])


__all__ = ["FEATURES", "Feature", "extract", "feature", "table", "true_diameter"]
