"""The filters of a log, zero phase, and the noise of a motion sensor behind them.

An encoder's counts, differentiated twice, are acceleration: J·a carries noise of its own, which no
law explains and every smoothing of the model lowers.  So the filter is set by it where the
description sets none, and no effect smaller than it is named.
"""

from collections.abc import Sequence
from functools import cache
from math import comb

import numpy as np
import scipy
from numba import njit

from spirob.errors import DataError
from spirob.machine.recordings.checks import EDGE, beside_gaps
from spirob.machine.recordings.clock import SHORTEST

BELOW = 0.5  # of the cutoff: edge of the last filter, where the first one passes 99.6 %
PAD = 2.0  # periods of the cutoff by which a signal is continued beyond its ends
PERIODS = 8  # of a filter, in a log at least
ALIAS = 0.4  # of the thinned sample rate: edge of the filter before thinning


def smooth(values: np.ndarray, cutoff: float, period: float) -> np.ndarray:
    """Zero-phase Butterworth filter of 4th order; above half the sample rate it passes all."""
    if cutoff * period >= 0.49:
        return values
    padding = max(30, round(PAD / (cutoff * period)))
    return _both_ways(*_low_pass(cutoff, period), values, padding)


def averaged(values: np.ndarray, count: int) -> np.ndarray:
    """Means of every `count` samples in a row, (n // count,); what is left over is dropped."""
    whole = len(values) // count * count
    return np.asarray(values[:whole].reshape(-1, count).mean(axis=1))


def as_fine(
    period: float, grids: list[dict[str, np.ndarray]], rate: float
) -> tuple[float, list[dict[str, np.ndarray]]]:
    """The grids and their sample period, by means of so many samples that at least `rate` is left.

    rate  Hz
    """
    count = int(1.0 / (period * rate) + 0.1)  # clocks differ by less between trials
    if count < 2:
        return period, grids
    return count * period, [{n: averaged(v, count) for n, v in g.items()} for g in grids]


def before_thinning(values: np.ndarray, every: int) -> np.ndarray:
    """The zero-phase filter that goes before keeping every n-th sample, same length."""
    return _both_ways(*_anti_alias(every), values, 60)


def rates(q: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative by time, (n,) each."""
    v = derivative(q, period)
    return v, derivative(v, period)


def derivative(values: np.ndarray, period: float) -> np.ndarray:
    """Derivative by central differences of 4th order, same length.

    At an eighth of the sample rate those of 2nd order are 10 % short, these 1 %.
    """
    if len(values) < 5:
        return np.asarray(np.gradient(values, period))
    return np.asarray(_differences(values, period))


@njit(cache=True, error_model="numpy")
def _differences(values: np.ndarray, period: float) -> np.ndarray:
    """Compiled, because most signals are so short that NumPy takes longer to be called."""
    n = len(values)
    out = np.empty(n)
    out[0], out[n - 1] = (values[1] - values[0]) / period, (values[-1] - values[-2]) / period
    out[1] = (values[2] - values[0]) / (2.0 * period)
    out[n - 2] = (values[-1] - values[-3]) / (2.0 * period)
    for k in range(2, n - 2):
        near, far = values[k + 1] - values[k - 1], values[k + 2] - values[k - 2]
        out[k] = (8.0 * near - far) / (12.0 * period)
    return out


def earlier(values: np.ndarray, by: float, period: float) -> np.ndarray:
    """Values (n,) as they were `by` seconds earlier, to second order."""
    if len(values) < 5:
        first, second = rates(values, period)
        return values - by * first + 0.5 * by**2 * second
    return np.asarray(_earlier(values, by, 0.5 * by**2, period))


@njit(cache=True, error_model="numpy")
def _earlier(values: np.ndarray, by: float, half_square: float, period: float) -> np.ndarray:
    first = _differences(values, period)
    return values - by * first + half_square * _differences(first, period)


@njit(cache=True)
def _both_ways(
    sections: np.ndarray, settled: np.ndarray, values: np.ndarray, padding: int
) -> np.ndarray:
    """`scipy.signal.sosfiltfilt` of values (n,), where the settled state of the filter is known.

    Finding that state takes it longer than to filter a thousand samples, and NumPy longer to be
    called than to continue them.
    """
    n = len(values)
    more = min(padding, n - 1)
    padded = np.empty(n + 2 * more)
    for k in range(more):
        padded[k] = 2.0 * values[0] - values[more - k]
        padded[more + n + k] = 2.0 * values[n - 1] - values[n - 2 - k]
    padded[more : more + n] = values
    _pass(sections, settled * padded[0], padded)
    backward = padded[::-1]
    _pass(sections, settled * backward[0], backward)
    return padded[more : more + n]


@njit(cache=True)
def _pass(sections: np.ndarray, state: np.ndarray, values: np.ndarray) -> None:
    """`scipy.signal.sosfilt` in place, bit for bit, which takes longer to be called than to filter.

    Two sections at a time, of which there is an even number: their states stay in registers.

    state  of each section, (sections, 2)
    """
    for s in range(0, len(sections), 2):
        a, b = sections[s], sections[s + 1]
        a0, a1, a2, a4, a5 = a[0], a[1], a[2], a[4], a[5]
        b0, b1, b2, b4, b5 = b[0], b[1], b[2], b[4], b[5]
        first, second = state[s, 0], state[s, 1]
        third, fourth = state[s + 1, 0], state[s + 1, 1]
        for k in range(len(values)):
            value = values[k]
            between = a0 * value + first
            first = a1 * value - a4 * between + second
            second = a2 * value - a5 * between
            passed = b0 * between + third
            third = b1 * between - b4 * passed + fourth
            fourth = b2 * between - b5 * passed
            values[k] = passed


@cache
def _low_pass(cutoff: float, period: float) -> tuple[np.ndarray, np.ndarray]:
    return _settled(scipy.signal.butter(4, cutoff, fs=1.0 / period, output="sos"))


@cache
def _anti_alias(every: int) -> tuple[np.ndarray, np.ndarray]:
    """That of `scipy.signal.decimate`."""
    return _settled(scipy.signal.cheby1(8, 0.05, 2.0 * ALIAS / every, output="sos"))


def _settled(sections: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A filter's sections, and its state after a constant of 1."""
    return sections, scipy.signal.sosfilt_zi(sections)


FASTEST = 50.0  # Hz; motors move their load within tens of milliseconds
SAMPLES = 8.0  # in a period of the cutoff
LEAST = 4.0  # of them in a slow log; in a period of what is compared there are twice as many
ENOUGH = 12.5  # Hz; a log is slow where its usual cutoff lies below
CLEAN = 0.01  # noise over RMS acceleration at which a cutoff is low enough
SLOWEST = 4.0  # times the frequency below which most of the effort lies
MOST = 0.9  # of its variance
MOSTLY = 0.75  # of an acceleration's variance that may count as noise
STEPS = 8  # from the fastest cutoff to the slowest


def sensor_noise(values: np.ndarray) -> float:
    """Deviation of the white noise on a signal, in its unit.

    From its differences of second to fourth order, in which a smooth signal vanishes sooner or
    later: white noise has √C(2k, k) times its deviation there, anything else adds to it.
    """
    orders = (2, 3, 4)
    return float(min(np.std(np.diff(values, n=k)) / np.sqrt(comb(2 * k, k)) for k in orders))


def acceleration_noise(values: np.ndarray, order: int, cutoff: float, period: float) -> float:
    """Deviation of the noise in a compared acceleration, from a position (order 2) or velocity (1).

    Compared is what passes the last filter.
    """
    return sensor_noise(values) * _passed(order, BELOW * cutoff, period)


def possible_cutoff(
    name: str, asked: float | None, usual: float, seconds: float, period: float, said: list[str]
) -> float:
    """The cutoff that is asked for where a log of so many seconds has room for it.

    Raises DataError where the log holds no `PERIODS` of it.
    """
    if asked is None:
        return usual
    if asked * seconds < PERIODS:
        raise DataError(
            f"{name}: filter.cutoff of {asked:.3g} Hz leaves nothing of {seconds:.3g} s; "
            f"give {PERIODS} periods of it at least"
        )
    if asked * period <= ALIAS:
        return asked
    beyond = f"a cutoff of {asked:.3g} Hz is beyond what {1 / period:.4g} samples a second hold"
    said.append(f"{name}: {beyond}; the usual {usual:.3g} Hz are used.")
    return usual


def usual_cutoff(values: np.ndarray, order: int, effort: np.ndarray, period: float) -> float:
    """The filter's cutoff [Hz] for a log on an even grid, where the description names none.

    It is low enough where the noise of the acceleration is a hundredth of it, or makes no more of
    the effort than the least effect that counts: where inertia asks for little, that noise, too.

    values  position (order 2) or velocity (1), which is differentiated to acceleration
    """
    usual, wanted = 1.0 / (SAMPLES * period), SLOWEST * _band(effort, period)
    fastest = min(FASTEST, max(usual, min(wanted, ENOUGH, 1.0 / (LEAST * period))))
    slowest = min(FASTEST, usual, wanted)
    inertia, most = _inertia(values, order, effort, slowest, period), CLEAN * float(np.std(effort))
    for cutoff in map(float, np.geomspace(fastest, slowest, STEPS)):
        size = float(np.std(_derived(smooth(values, BELOW * cutoff, period), order, period)))
        noise = acceleration_noise(values, order, cutoff, period)
        if noise <= CLEAN * size or (cutoff <= ENOUGH and inertia * noise <= most):
            return cutoff
    return slowest


def _inertia(
    values: np.ndarray, order: int, effort: np.ndarray, cutoff: float, period: float
) -> float:
    """What of an effort an acceleration asks for, by a fit of it, the speed and a constant.

    What a spring or a weight asks for is taken as the acceleration's, too.
    """
    passed = smooth(values, BELOW * cutoff, period)
    speed = _derived(passed, order - 1, period)
    columns = np.column_stack([np.ones(len(speed)), speed, derivative(speed, period)])
    asked = smooth(effort, BELOW * cutoff, period)
    return abs(float(np.linalg.lstsq(columns, asked, rcond=None)[0][-1]))


def least_cutoff(values: np.ndarray, period: float) -> float:
    """The cutoff [Hz] from which on most of a signal (n,) is in what is compared."""
    return _band(values, period) / BELOW


def roomy_cutoff(cutoff: float, least: float, filled: Sequence[np.ndarray], period: float) -> float:
    """The cutoff [Hz], or the next one to it that leaves enough rows, and most of a log's.

    A filter smears what is beside the ends of pieces and beside rows that the log does not hold:
    where it is set low for the noise, little may be left, which tells less than noise does: most
    of a short log's rows are less than a trial lasts.  Where no cutoff above leaves most, as gaps
    come again and again, one below may, beside which they are short, down to the `least`.

    filled  rows of each piece that the log does not hold
    """
    rows = sum(len(piece) for piece in filled)
    highest = max(cutoff, min(FASTEST, 1.0 / (LEAST * period)))
    above = np.geomspace(cutoff, highest, STEPS)
    below = np.geomspace(cutoff, min(cutoff, least), STEPS)
    tried = [float(other) for other in (*above, *below)]
    left = [sum(_clear(piece, other * period) for piece in filled) for other in tried]
    enough = min(SHORTEST / period, max(left))
    fit = (c for c, n in zip(tried, left, strict=True) if n > 0.5 * rows and n >= enough)
    return next(fit, cutoff)


def _clear(filled: np.ndarray, cutoff: float) -> int:
    """Rows of a piece that a filter of this cutoff, in periods of the samples, does not smear."""
    beside = ~beside_gaps(filled, cutoff)
    ends = round(EDGE / cutoff)
    return int(np.count_nonzero(beside[ends : max(len(beside) - ends, ends)]))


def thinned(
    name: str,
    every: tuple[int, int],
    effort: np.ndarray,
    cutoff: float,
    period: float,
    said: list[str],
) -> int:
    """Of how many rows one is compared: as asked where the effort's band (n,) allows, or as usual.

    every  as asked, and as usual
    """
    asked, usual = every
    edge = BELOW * min(cutoff, SLOWEST * _band(effort, period))
    most = max(1, int(min(ALIAS / (edge * period), len(effort)))) if edge > 0.0 else asked
    if asked > most:
        said.append(
            f"{name}: a filter.decimate of {asked} leaves {ALIAS / (asked * period):.2g} Hz of an "
            f"effort that needs {edge:.2g} Hz; {usual} is used, as usual."
        )
    return asked if asked <= most else usual


def noise_in_effort(noise: float, effort: np.ndarray, motion: np.ndarray) -> tuple[float, float]:
    """RMS of what noise of the acceleration leaves of an effort, and by what share inertia is low.

    Of an effort J·a, where a has the variance A² with noise s² in it, least squares find the
    inertia J·(1 - s²/A²), and leave J·s·√(1 - s²/A²).  What speed tells of a is not counted.

    effort  as it is modelled, (N,)
    motion  position, speed and acceleration, filtered alike, (N, 3)
    """
    columns = np.column_stack([np.ones(len(motion)), motion])
    found = abs(float(np.linalg.lstsq(columns, effort, rcond=None)[0][-1]))
    speed, a = motion[:, 1], motion[:, 2]
    own = a - speed * (speed @ a) / max(float(speed @ speed), 1e-300)
    share = min(noise**2 / max(float(np.mean(own**2)), 1e-300), MOSTLY)
    return found * noise / float(np.sqrt(1.0 - share)), share


def _derived(values: np.ndarray, order: int, period: float) -> np.ndarray:
    for _ in range(order):
        values = derivative(values, period)
    return values


def _band(effort: np.ndarray, period: float) -> float:
    """Frequency below which most of the effort's variance lies [Hz]."""
    lines, power = scipy.signal.periodogram(effort - effort.mean(), 1.0 / period)
    share = np.cumsum(power) / max(float(np.sum(power)), 1e-300)
    return float(lines[min(int(np.searchsorted(share, MOST)), len(lines) - 1)])


@cache
def _passed(order: int, cutoff: float, period: float) -> float:
    """Deviation of the acceleration for white noise of deviation 1 on what is differentiated."""
    return float(np.std(_derived(smooth(_white(), cutoff, period), order, period)))


def _white() -> np.ndarray:
    return np.random.default_rng(0).standard_normal(20_000)
