"""What the contact detector sees, for a whole log at once: to try many thresholds on many trials.

The same windows and rules as `contact.ContactDetector`, which is what a robot runs; a test holds
one against the other.
"""

from dataclasses import dataclass

import numpy as np

from spirob.perceive.contact import RULES, ContactSettings


@dataclass(frozen=True)
class Levels:
    """Baseline i_0 [A], rise s (i - i_0) [A] and slope s di/dt [A/s] at every sample, (T,) each.

    NaN until the windows are full, where no rule holds.
    """

    baseline: np.ndarray
    rise: np.ndarray
    slope: np.ndarray


def levels(values: np.ndarray, settings: ContactSettings, period: float = 1e-3) -> Levels:
    """Levels of a current [A] as a detector that is reset at its first sample sees them."""
    window = max(3, round(settings.window / period))
    before = max(1, round(settings.baseline / period))
    recent = min(max(1, round(settings.smoothing / period)), window)
    out = np.full((3, len(values)), np.nan)
    if len(values) >= window + before:
        ready = slice(window + before - 1, None)
        centred = np.arange(window) - (window - 1) / 2
        line = centred / (centred @ centred) / period
        base = _mean(values, before)[: len(values) - window - before + 1]
        side = np.where(base >= 0.0, 1.0, -1.0)
        level = _mean(values, recent)[window + before - recent :]
        # convolve turns its second argument round
        slope = np.convolve(values, line[::-1], mode="valid")[before:]
        out[:, ready] = base, side * (level - base), side * slope
    return Levels(*out)


def declared(seen: Levels, settings: ContactSettings, period: float = 1e-3) -> int | None:
    """Sample at which the rules declare a contact, or None."""
    confirm = max(1, round(settings.confirm / period))
    base = np.maximum(np.abs(seen.baseline), settings.least_baseline)
    exceeded = {
        "absolute": seen.rise > settings.absolute,
        "relative": seen.rise > settings.relative * base,
        "slope": seen.slope > settings.slope,
    }
    found = [_held(exceeded[rule], confirm) for rule in RULES]
    samples = [k for k in found if k is not None]
    return min(samples) if samples else None


def _mean(values: np.ndarray, width: int) -> np.ndarray:
    return np.convolve(values, np.full(width, 1.0 / width), mode="valid")


def _held(holds: np.ndarray, confirm: int) -> int | None:
    """Last sample of the first run of that many."""
    if len(holds) < confirm:
        return None
    runs = np.convolve(holds, np.ones(confirm), mode="valid") > confirm - 0.5
    return int(np.argmax(runs)) + confirm - 1 if runs.any() else None
