"""Tables for the report: measured and modelled signals side by side, and the arm in motion."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from spirob.identify.residual import Residual
from spirob.logs.atomic import replacing
from spirob.robot import MOTORS

FRAMES_PER_SECOND = 30
CHANNELS = ("current", "displacement", "velocity")


def overlay(
    root: Path,
    residuals: Mapping[str, Residual],
    base: Mapping[str, float],
    named: Mapping[str, float],
) -> None:
    """data/diagnosis/overlay.parquet: trials that no fit has seen, both sides filtered alike."""
    parts = []
    for role in ("validate", "heldout"):
        residual = residuals[role]
        for k, trial in enumerate(residual.trials):
            sides = {
                "measured": trial,
                "base": residual.respond(base, k),
                "named": residual.respond(named, k),
            }
            thin = residual.filter.thin
            for m, motor in enumerate(MOTORS):
                columns = {
                    f"{side}_{channel}": thin(getattr(signals, channel)[:, m], trial.name)
                    for channel in CHANNELS
                    for side, signals in sides.items()
                }
                time = trial.seconds[:: residual.filter.every]
                about = {"trial": trial.name, "role": role, "motor": motor, "time": time}
                parts.append(pd.DataFrame(about | columns))
    _write(root / "data/diagnosis/overlay.parquet", pd.concat(parts, ignore_index=True))


def finalists(
    root: Path, residuals: Mapping[str, Residual], fits: Mapping[str, Mapping[str, float]]
) -> None:
    """data/diagnosis/finalists.parquet: response with each candidate added and all refitted.

    fits  numbers of the full fit with that candidate alone, by its name; rows are the overlay's
    """
    parts = []
    for role in ("validate", "heldout"):
        residual = residuals[role]
        for k, trial in enumerate(residual.trials):
            for name, changes in fits.items():
                response = residual.respond(changes, k)
                for m, motor in enumerate(MOTORS):
                    about = {"effect": name, "trial": trial.name, "role": role, "motor": motor}
                    time = trial.seconds[:: residual.filter.every]
                    columns = {
                        channel: residual.filter.thin(getattr(response, channel)[:, m], trial.name)
                        for channel in CHANNELS
                    }
                    parts.append(pd.DataFrame(about | {"time": time} | columns))
    if parts:
        _write(root / "data/diagnosis/finalists.parquet", pd.concat(parts, ignore_index=True))


def motion(root: Path, residuals: Mapping[str, Residual], changes: Mapping[str, float]) -> None:
    """data/diagnosis/motion.parquet: hinge angles of the best model in the held-out trials."""
    parts = []
    residual = residuals["heldout"]
    for k, trial in enumerate(residual.trials):
        angles = residual.respond(changes, k).angles
        rows = np.arange(0, len(angles), round(1000 / FRAMES_PER_SECOND))
        columns = {f"q{i}": angles[rows, i] for i in range(angles.shape[1])}
        parts.append(pd.DataFrame({"trial": trial.name, "time": rows * 1e-3} | columns))
    _write(root / "data/diagnosis/motion.parquet", pd.concat(parts, ignore_index=True))


def _write(path: Path, table: pd.DataFrame) -> None:
    with replacing(path) as temporary:
        table.to_parquet(temporary, compression="zstd", index=False)
