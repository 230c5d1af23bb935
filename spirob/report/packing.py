"""Signals as 16-bit integers in base64: a quarter of the size of a double, finer than a pixel.

A packed signal is {"low", "step", "data"}; sample = low + step·(integer + 32767), and the integer
-32768 stands for a missing sample.  `assets/packing.js` is the other half.
"""

import base64
from typing import Any

import numpy as np

LEVELS = 65534  # from -32767 to 32767
MISSING = -32768


def pack(signal: np.ndarray) -> dict[str, Any] | None:
    """Pack one signal; None when it holds no finite sample."""
    signal = np.asarray(signal, float)
    finite = np.isfinite(signal)
    if not finite.any():
        return None
    low, high = float(signal[finite].min()), float(signal[finite].max())
    step = (high - low) / LEVELS or 1.0
    level = np.full(signal.shape, MISSING, "<i2")
    level[finite] = np.round((signal[finite] - low) / step) - LEVELS // 2
    return {"low": low, "step": step, "data": base64.b64encode(level.tobytes()).decode("ascii")}


def unpack(packed: dict[str, Any]) -> np.ndarray:
    """The signal again, to within half a step."""
    level = np.frombuffer(base64.b64decode(packed["data"]), "<i2").astype(float)
    level[level == MISSING] = np.nan
    return packed["low"] + packed["step"] * (level + LEVELS // 2)


def stride(samples: int, most: int) -> int:
    """Keep every so-many-th sample so that at most `most` are left."""
    return max(1, -(-samples // most))
