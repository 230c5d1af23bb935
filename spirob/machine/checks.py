"""Is this log fit to be judged?  A clear refusal, or a repair that is said aloud.

Every function takes and returns plain arrays; what it changed it appends to `said`, and what it
cannot repair it raises as DataError.  A diagnosis from bad data would be believed like any other.
"""

from collections.abc import Sequence

import numpy as np

from spirob.errors import DataError, NothingLeft
from spirob.machine.clock import SHORTEST
from spirob.machine.filtering import smooth

REGISTERS = (16, 32)  # bits
COUNTS = 50  # different whole numbers without a fraction: counts, not radians or metres
LARGEST, SMALLEST = 1e100, 1e-100  # sizes whose squares are still numbers
NOISE = 0.5  # of a motion's variance: more beyond what is compared is no motion


def signed(where: str, name: str, raw: np.ndarray, said: list[str]) -> np.ndarray:
    """A register of 16 or 32 bits that was read as unsigned: what is near its top is negative."""
    known = raw[np.isfinite(raw)]
    if not len(known) or np.any(known != np.round(known)) or known.min() < 0:
        return raw
    for bits in REGISTERS:
        quarter = 2 ** (bits - 2)
        low, high = known < quarter, known >= 3 * quarter
        if np.all(low | high) and low.any() and high.any() and known.max() < 4 * quarter:
            said.append(
                f"{where}: '{name}' holds negative numbers of {bits} bits as {3 * quarter} and "
                "more; read as negative."
            )
            return np.where(raw >= 3 * quarter, raw - 4.0 * quarter, raw)
    return raw


def enough(where: str, used: float, lost: str = "") -> None:
    """Raise NothingLeft where rows that are compared last for less than a trial needs.

    used  [s];  lost  what was left out, where that is known
    """
    if used < SHORTEST:
        why = f" ({lost})" if lost else ""
        raise NothingLeft(f"{where}: only {used:.2g} s are left after the row filters{why}")


def moving(where: str, name: str, values: np.ndarray) -> None:
    """Raise NothingLeft where a channel never changes, DataError where it holds no sizes."""
    known = values[np.isfinite(values)]
    if not len(known):
        raise DataError(f"{where}: column '{name}' has no number in any row")
    size = float(np.max(np.abs(known)))
    if size > LARGEST or 0.0 < size < SMALLEST:
        raise DataError(f"{where}: column '{name}' reaches {size:.3g}; is its factor right?")
    if np.ptp(known) <= 1e-12 * size:
        raise NothingLeft(
            f"{where}: column '{name}' is constant at {known[0]:g}; nothing can be told from it"
        )


def not_counts(where: str, name: str, values: np.ndarray, raw: np.ndarray) -> None:
    """Raise where a position holds whole numbers that no factor scales; raw is as logged."""
    raw, values = raw[np.isfinite(raw)], values[np.isfinite(raw)]
    scaled = abs(np.ptp(values) / np.ptp(raw) - 1.0) > 1e-6
    if not scaled and np.all(raw == np.round(raw)) and len(np.unique(raw)) > COUNTS:
        raise DataError(
            f"{where}: '{name}' holds whole numbers only, {raw.min():g} to {raw.max():g}: "
            "these are counts; give their size as 'factor'"
        )


def a_motion(
    where: str, name: str, pieces: Sequence[np.ndarray], edge: float, period: float
) -> None:
    """Raise where most of a position is faster than what is compared, up to `edge` [Hz]."""
    slow = [smooth(values, edge, period) for values in pieces]
    fast = sum(float(np.sum((a - b) ** 2)) for a, b in zip(pieces, slow, strict=True))
    whole = sum(float(np.sum((values - values.mean()) ** 2)) for values in pieces)
    if fast > NOISE * whole:
        raise DataError(
            f"{where}: '{name}' is no motion that can be followed: {fast / whole:.0%} of its "
            f"variance lies above {edge:.3g} Hz; is it another column?"
        )
