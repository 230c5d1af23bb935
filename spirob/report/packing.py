"""Signals as 16-bit integers in base64: a quarter of the size of a double, finer than a pixel.

A packed signal is {"low", "step", "data"}; sample = low + step·(integer + 32767), and the integer
-32768 stands for a missing sample.  A small change of another signal does with 8 bits, "coarse":
low + step·(integer + 127), -128 missing.  `assets/packing.js` is the other half.
"""

import base64
from typing import Any

import numpy as np

FINE, COARSE = np.dtype("<i2"), np.dtype("i1")


def pack(signal: np.ndarray, coarse: bool = False) -> dict[str, Any] | None:
    """Pack one signal; None when it holds no finite sample."""
    signal = np.asarray(signal, float)
    finite = np.isfinite(signal)
    if not finite.any():
        return None
    kind = COARSE if coarse else FINE
    most = int(np.iinfo(kind).max)
    low, high = float(signal[finite].min()), float(signal[finite].max())
    step = (high - low) / (2 * most) or 1.0
    level = np.full(signal.shape, -most - 1, kind)
    level[finite] = np.round((signal[finite] - low) / step) - most
    data = base64.b64encode(level.tobytes()).decode("ascii")
    return {"low": low, "step": step, "data": data} | ({"coarse": True} if coarse else {})


def unpack(packed: dict[str, Any]) -> np.ndarray:
    """The signal again, to within half a step."""
    kind = COARSE if packed.get("coarse") else FINE
    most = np.iinfo(kind).max
    level = np.frombuffer(base64.b64decode(packed["data"]), kind).astype(float)
    level[level == -most - 1] = np.nan
    return np.asarray(packed["low"] + packed["step"] * (level + most))


def stride(samples: int, most: int) -> int:
    """Keep every so-many-th sample so that at most `most` are left."""
    return max(1, -(-samples // most))
