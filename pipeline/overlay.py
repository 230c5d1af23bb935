"""Tables for the report: measured and modelled signals side by side, and the arm in motion."""

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from pipeline.stage import workers
from spirob.files import replacing
from spirob.identify.residual import Residual
from spirob.robot import MOTORS

FRAMES_PER_SECOND = 30
CHANNELS = ("current", "displacement", "velocity")


def overlay(
    folder: Path,
    residuals: Mapping[str, Residual],
    base: Mapping[str, float],
    named: Mapping[str, float],
) -> None:
    """overlay.parquet: trials that no fit has seen, both sides filtered alike."""
    table = table_of(residuals, {"base": base, "named": named}, measured=True)
    write_table(folder / "overlay.parquet", table)


def table_of(
    residuals: Mapping[str, Residual],
    models: Mapping[str, Mapping[str, float]],
    measured: bool = False,
) -> pd.DataFrame:
    """Columns NAME_CHANNEL of each model, by its numbers, in the trials that no fit has seen.

    One row for each kept sample of each motor: trial, role, motor, time [s]; SI.
    measured  the robot's own signals besides
    """
    trials = [(r, k) for r in ("validate", "heldout") for k in range(len(residuals[r].trials))]
    jobs = [(role, k, changes) for role, k in trials for changes in models.values()]
    with ThreadPoolExecutor(workers()) as pool:  # the compiled loop runs without the GIL
        responses = iter(
            list(pool.map(lambda job: residuals[job[0]].respond(job[2], job[1]), jobs))
        )
    parts = []
    for role, k in trials:
        residual, trial = residuals[role], residuals[role].trials[k]
        sides: dict[str, Any] = {"measured": trial} if measured else {}
        sides |= {name: next(responses) for name in models}
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
    return pd.concat(parts, ignore_index=True)


def motion(folder: Path, residuals: Mapping[str, Residual], changes: Mapping[str, float]) -> None:
    """motion.parquet: hinge angles of the best model in the held-out trials."""
    parts = []
    residual = residuals["heldout"]
    for k, trial in enumerate(residual.trials):
        angles = residual.respond(changes, k).angles
        rows = np.arange(0, len(angles), round(1000 / FRAMES_PER_SECOND))
        columns = {f"q{i}": angles[rows, i] for i in range(angles.shape[1])}
        parts.append(pd.DataFrame({"trial": trial.name, "time": rows * 1e-3} | columns))
    write_table(folder / "motion.parquet", pd.concat(parts, ignore_index=True))


def write_table(path: Path, table: pd.DataFrame) -> None:
    """Write a table whole or not at all."""
    with replacing(path) as temporary:
        table.to_parquet(temporary, compression="zstd", index=False)
