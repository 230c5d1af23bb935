"""How much of the effort is hidden: what numbers of the description cannot take up.

The effort is fitted by acceleration and speed of the motion as it is reported, beside what the
description knows of it, without noise and without delay; all pass the filter that a log of this
rate allows.  What is left, over the effort, is how much is hidden.
"""

from collections.abc import Callable, Sequence

import numpy as np
import scipy

from spirob.campaign.simulators.motion import FINE, Motion

LOW, HIGH = 0.12, 0.40  # of the effort: what is drawn
NEAR = (0.9, 1.1)  # of the wanted share: near enough
SEEN = 0.1  # of the effort: what a diagnosis can be asked for
TRIES = 6
FASTEST, SAMPLES = 20.0, 16.0  # Hz, and samples in a period, of what a log shows
EDGE = 0.5  # s at both ends, where the filter has no neighbours


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


def strength(shown: Callable[[float], float], wanted: float, most: float) -> tuple[float, float]:
    """The strength at which a kind shows as much as is wanted, as nearly as can be; and the share.

    Where no strength shows it, it is moderate: what cannot be seen is no reason for a monster.

    shown  share at a strength
    """
    tried: list[tuple[float, float]] = []
    at = min(2.0 * wanted, most)
    for _ in range(TRIES):
        tried.append((at, shown(at)))
        ratio = wanted / max(tried[-1][1], 1e-6)
        if 1 / NEAR[1] < ratio < 1 / NEAR[0]:
            break
        at = min(max(_next(tried, wanted), 1e-3), most)
        if any(abs(at - before) < 1e-3 * at for before, _ in tried):
            break
    if max(found for _, found in tried) < SEEN:
        return tried[0]
    return min(tried, key=lambda one: abs(np.log(max(one[1], 1e-6) / wanted)))


def _next(tried: Sequence[tuple[float, float]], wanted: float) -> float:
    """Between the nearest below and above where there are both, else further in proportion."""
    below = [one for one in tried if one[1] < wanted]
    above = [one for one in tried if one[1] >= wanted]
    if below and above:
        (a, low), (b, high) = max(below, key=lambda o: o[1]), min(above, key=lambda o: o[1])
        part = np.log(wanted / max(low, 1e-6)) / np.log(high / max(low, 1e-6))
        return float(np.exp(np.log(a) + min(max(part, 0.15), 0.85) * np.log(b / a)))
    at, shown = tried[-1]
    return float(at * min(max(wanted / max(shown, 1e-6), 0.1), 6.0))
