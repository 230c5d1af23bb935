"""The arm's motion for the page: hinge angles, packed, and the lengths needed to draw it."""

import re
from typing import Any

import numpy as np
import pandas as pd

from spirob.geometry import SpiralArm, spiral_arm
from spirob.report.packing import pack, stride

MOST_FRAMES = 900  # of one trial: half a minute at 30 frames a second
BUDGET = 700_000  # bytes of base64 for all trials together
HINGE = re.compile(r"q\d+")


def payload(motion: pd.DataFrame) -> dict[str, Any]:
    """Geometry in mm, and for each trial its times and angles [rad], frame after frame."""
    hinges = [name for name in motion.columns if HINGE.fullmatch(name)]
    hinges.sort(key=lambda name: int(name[1:]))
    groups = list(motion.groupby("trial", sort=False))
    most = int(min(MOST_FRAMES, BUDGET / (8 / 3 * len(hinges) * max(len(groups), 1))))
    trials = []
    for name, rows in groups:
        rows = rows.sort_values("time")
        kept = rows.iloc[:: stride(len(rows), max(most, 2))]
        trials.append(
            {
                "name": str(name),
                "time": pack(kept["time"].to_numpy()),
                "angles": pack(kept[hinges].to_numpy(float).ravel()),
            }
        )
    return {"geometry": _geometry(spiral_arm(len(hinges))), "trials": trials}


def _geometry(arm: SpiralArm) -> dict[str, Any]:
    return {
        "faceSlope": round(float(np.tan(arm.unit_angle / 2)), 6),
        "length": _millimetres(arm.unit_length),
        "halfWidth": _millimetres(arm.half_width),
        "guideBefore": _millimetres(arm.guide_before),
        "guideAfter": _millimetres(arm.guide_after),
    }


def _millimetres(lengths: np.ndarray) -> list:
    return np.round(1e3 * lengths, 3).tolist()
