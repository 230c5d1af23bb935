"""The arm's motion for the page: hinge angles, packed, and the lengths needed to draw it.

`film` renders a clip of it, or says why there is none.
"""

import importlib.util
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from spirob.geometry import PUBLISHED, SpiralArm
from spirob.report.figures import pack, stride
from spirob.unit_table import Geometry

MOST_FRAMES = 900  # of one trial: half a minute at 30 frames a second
BUDGET = 700_000  # bytes of base64 for all trials together
HINGE = re.compile(r"q\d+")


def payload(
    motion: pd.DataFrame,
    posture: pd.DataFrame | None = None,
    geometry: Geometry = PUBLISHED,
) -> dict[str, Any]:
    """The model's motion and, where the robot's own is known, that on top of it.

    Geometry in mm, and for each trial its times and angles [rad], frame after frame.
    """
    most = BUDGET if posture is None else BUDGET // 2
    shown = [str(name) for name in motion["trial"].unique()]
    robot = None
    if posture is not None and len(kept := posture[posture["trial"].isin(shown)]):
        robot = _body(kept, most, geometry)
    return _body(motion, most, geometry) | {"robot": robot}


def apart(
    motion: pd.DataFrame, posture: pd.DataFrame, geometry: Geometry = PUBLISHED
) -> np.ndarray:
    """Distance of the model's tip from the robot's over all frames of all trials [m]."""
    found = []
    for name, rows in motion.groupby("trial", sort=False):
        seen = posture[posture["trial"] == name].sort_values("time")
        if len(seen) < 2:
            continue
        times, ours = _tips(rows.sort_values("time"), geometry)
        known, theirs = _tips(seen, geometry)
        both = [np.interp(times, known, theirs[:, k]) for k in (0, 1)]
        found.append(np.hypot(ours[:, 0] - both[0], ours[:, 1] - both[1]))
    return np.concatenate(found) if found else np.zeros(0)


def _tips(rows: pd.DataFrame, geometry: Geometry) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and positions of the tip [m] (frames, 2)."""
    names = hinges(rows)
    heading = np.cumsum(rows[names].to_numpy(float), axis=1)
    length = geometry.arm(len(names)).unit_length
    tip = np.stack([np.cos(heading) @ length, np.sin(heading) @ length], axis=1)
    return rows["time"].to_numpy(float), tip


def _body(motion: pd.DataFrame, budget: int, geometry: Geometry) -> dict[str, Any]:
    names = hinges(motion)
    groups = list(motion.groupby("trial", sort=False))
    most = int(min(MOST_FRAMES, budget / (8 / 3 * len(names) * max(len(groups), 1))))
    trials = []
    for name, rows in groups:
        rows = rows.sort_values("time")
        kept = rows.iloc[:: stride(len(rows), max(most, 2))]
        trials.append(
            {
                "name": str(name),
                "time": pack(kept["time"].to_numpy()),
                "angles": pack(kept[names].to_numpy(float).ravel()),
            }
        )
    return {"geometry": _geometry(geometry.arm(len(names))), "trials": trials}


def hinges(table: pd.DataFrame) -> list[str]:
    found = [name for name in table.columns if HINGE.fullmatch(name)]
    return sorted(found, key=lambda name: int(name[1:]))


def _geometry(arm: SpiralArm) -> dict[str, Any]:
    return {
        "faceSlope": np.round(np.tan(arm.unit_angle / 2), 6).tolist(),
        "length": _millimetres(arm.unit_length),
        "halfWidth": _millimetres(arm.half_width),
        "guideBefore": _millimetres(arm.guide_before),
        "guideAfter": _millimetres(arm.guide_after),
    }


def _millimetres(lengths: np.ndarray) -> list:
    return np.round(1e3 * lengths, 3).tolist()


RATE = 12.5  # frames a second
LONGEST = 8.0  # s
PATIENCE = 60.0  # s, for the whole clip
LARGEST = 900_000  # bytes, so that the page stays below 8 MB


class NoClip(Exception):
    """Why there is no clip, in a sentence."""


def film(motion: pd.DataFrame, geometry: Geometry = PUBLISHED) -> bytes:
    """The first trial of the motion as an animated WebP.

    Raises NoClip where Pillow or OpenGL is absent, or the clip grows too large.
    """
    if importlib.util.find_spec("PIL") is None:
        raise NoClip("Pillow, which writes it, is not installed (pip install pillow)")
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder, "motion.npz"), Path(folder, "clip.webp")
        angles = _angles(motion)
        np.savez(source, angles=angles, **vars(geometry.arm(angles.shape[1])))
        _render(source, target)
        clip = target.read_bytes()
    if len(clip) > LARGEST:
        raise NoClip(f"it took {len(clip)} bytes, more than the page has room for")
    return clip


def _angles(motion: pd.DataFrame) -> np.ndarray:
    """Hinge angles [rad] of the first trial at the clip's rate, (frames, N)."""
    rows = motion[motion["trial"] == motion["trial"].iloc[0]].sort_values("time")
    seconds = rows["time"].to_numpy(float)
    wanted = np.arange(seconds[0], min(seconds[-1], seconds[0] + LONGEST), 1 / RATE)
    names = hinges(rows)
    return np.column_stack([np.interp(wanted, seconds, rows[name].to_numpy()) for name in names])


def _render(source: Path, target: Path) -> None:
    asked = [sys.executable, "-m", "spirob.report.clip", str(source), str(target)]
    given = {"MUJOCO_GL": "egl", **os.environ}  # needs no screen; the user's own choice comes first
    try:
        ran = subprocess.run(asked, env=given, capture_output=True, text=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired as error:
        raise NoClip(f"rendering took longer than {PATIENCE:.0f} s") from error
    if ran.returncode or not target.exists():
        said = ran.stderr.strip().splitlines() or [f"it ended with code {ran.returncode}"]
        raise NoClip(f"OpenGL does not work here ({said[-1]})")
