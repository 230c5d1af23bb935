"""When each regime of the atlas holds, in the trials that the overlay shows.

The atlas is of the training trials; the overlay shows others.  Its signals are what the regimes are
defined on, so the same definitions mark the same situations there.
"""

from typing import Any

import numpy as np
import pandas as pd

from spirob.diagnosis.regimes import masks_of
from spirob.identify.problem import Stretch
from spirob.identify.residual import STILL

Spans = dict[str, list[list[float]]]  # regime -> from, to [s]


def spans(rows: pd.DataFrame, trial: str, motor: str) -> Spans:
    """Times of each regime for one motor of one trial, from its measured signals (SI)."""
    rows = rows.sort_values("time")
    seconds = rows["time"].to_numpy(float)
    return {name: _runs(seconds, mask) for name, mask in masks(rows, trial, motor).items()}


def masks(rows: pd.DataFrame, trial: str, motor: str) -> dict[str, np.ndarray]:
    """Samples of each regime, for rows in the order of time; none where a signal has gaps."""
    seconds, position, velocity, current = (
        rows[name].to_numpy(float)
        for name in ("time", "measured_displacement", "measured_velocity", "measured_current")
    )
    if len(rows) < 2 or not np.isfinite([position, velocity, current]).all():
        return {}
    piece = Stretch(
        trial,
        f"{motor} motor",
        seconds,
        position,
        velocity,
        current,
        STILL,
        "winding in",
        "paying out",
    )
    return masks_of(piece)


def driven(compare: dict[str, Any]) -> set[tuple[str, str]]:
    """Trial and motor wherever the motor was not held at a commanded current."""
    return {
        (trial["name"], name)
        for trial in compare.get("trials", ())
        for name, motor in trial["motors"].items()
        if motor.get("driven", True)
    }


def _runs(seconds: np.ndarray, mask: np.ndarray) -> list[list[float]]:
    """First and last time of each run of true samples."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    pairs = edges.reshape(-1, 2)
    return [[round(float(seconds[a]), 3), round(float(seconds[b - 1]), 3)] for a, b in pairs]
