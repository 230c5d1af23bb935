"""When a signal answers a step, and by how much it differs from its twin without a disturbance."""

import numpy as np

PERIOD = 1e-3  # s, of every signal here
SETTLED = 5  # samples over which a noisy signal has to stay beyond a level


def smooth(values: np.ndarray, samples: int) -> np.ndarray:
    """Centred mean over an odd number of samples; ends repeat their last value."""
    half = samples // 2
    padded = np.pad(values, half, mode="edge")
    return np.convolve(padded, np.ones(2 * half + 1) / (2 * half + 1), mode="valid")


def crossing(values: np.ndarray, level: float) -> float:
    """First time [s] at which a signal reaches a level and stays for `SETTLED` samples.

    Between samples by a straight line; NaN where it never does.
    """
    beyond = values >= level
    run = np.convolve(beyond, np.ones(SETTLED), mode="valid") == SETTLED
    if not run.any():
        return float("nan")
    k = int(np.argmax(run))
    if k == 0:
        return 0.0
    step = values[k] - values[k - 1]
    return PERIOD * (k - 1 + float(np.clip((level - values[k - 1]) / step, 0.0, 1.0)))


def step_times(values: np.ndarray, begins: float, settled: tuple[float, float]) -> dict[str, float]:
    """Delay and rise of the answer to a step that is commanded at `begins` [s].

    The answer goes from the mean of the 0.1 s before to its mean between two times `settled` [s].
    delay  until half of it [s];  rise  from a tenth to nine tenths of it [s]
    """
    first = round(begins / PERIOD)
    start = float(np.mean(values[max(first - 100, 0) : first + 1]))
    last = slice(round(settled[0] / PERIOD), round(settled[1] / PERIOD))
    height = float(np.mean(values[last])) - start
    if height == 0.0:
        return {"delay": float("nan"), "rise": float("nan"), "height": 0.0}
    share = (values[first:] - start) / height
    tenth, half, most = (crossing(share, level) for level in (0.1, 0.5, 0.9))
    return {"delay": half, "rise": most - tenth, "height": height}


def strongest_period(values: np.ndarray, shortest: float, longest: float) -> float:
    """Period [s] of the strongest line of a signal without its trend, within two bounds [s].

    The signal is padded to eight times its length, so that lines lie close; NaN where it is flat.
    """
    n = len(values)
    time = np.arange(n)
    level = values - np.polyval(np.polyfit(time, values, 1), time)
    power = np.abs(np.fft.rfft(level * np.hanning(n), 8 * n)) ** 2
    frequency = np.fft.rfftfreq(8 * n, PERIOD)
    band = (frequency >= 1 / longest) & (frequency <= 1 / shortest)
    if power[band].max() <= 1e-24 * n:
        return float("nan")
    return float(1 / frequency[band][np.argmax(power[band])])


def amplitude(values: np.ndarray, period: float) -> float:
    """Amplitude of the line of that period in a signal without its trend, in the signal's unit."""
    n = round(int(len(values) * PERIOD / period) * period / PERIOD)  # whole periods
    time = np.arange(n) * PERIOD
    level = values[:n] - np.polyval(np.polyfit(time, values[:n], 1), time)
    return float(2 / n * abs(level @ np.exp(-2j * np.pi * time / period)))
