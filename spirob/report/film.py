"""A rendered clip of the arm for the page, or the reason why there is none."""

import importlib.util
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

from spirob.geometry import PUBLISHED
from spirob.report.arm import hinges
from spirob.unit_table import Geometry

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
    asked = [sys.executable, "-m", "spirob.report.render", str(source), str(target)]
    given = {"MUJOCO_GL": "egl", **os.environ}  # needs no screen; the user's own choice comes first
    try:
        ran = subprocess.run(asked, env=given, capture_output=True, text=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired as error:
        raise NoClip(f"rendering took longer than {PATIENCE:.0f} s") from error
    if ran.returncode or not target.exists():
        said = ran.stderr.strip().splitlines() or [f"it ended with code {ran.returncode}"]
        raise NoClip(f"OpenGL does not work here ({said[-1]})")
