"""Stage `compare`: the identified model against every trial that it was not fitted to."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.model import plant, residual
from pipeline.stage import entry, public_config, read_json, tell, write_json
from spirob.identify.intervals import score
from spirob.identify.residual import Residual
from spirob.robot import MOTORS

CHANNELS = {"current": "A", "displacement": "m", "velocity": "m/s"}
LONGEST_DELAY = 50  # samples at 1 kHz


def compare(residual: Residual, changes: Mapping[str, float]) -> list[dict[str, Any]]:
    """Scores of every trial, motor and channel, both sides filtered alike.

    One entry a trial: name, role, and for each motor whether it was driven, the scores of
    current, displacement and velocity with their units, and the delay of the measurement [ms].
    """
    entries = []
    for k, trial in enumerate(residual.trials):
        response = residual.respond(changes, k)
        driven = residual.driven(trial)
        motors: dict[str, Any] = {}
        for m, motor in enumerate(MOTORS):
            entry: dict[str, Any] = {"driven": m in driven}
            for channel, unit in CHANNELS.items():
                measured = residual.filter.thin(getattr(trial, channel)[:, m], trial.name)
                modelled = residual.filter.thin(getattr(response, channel)[:, m], trial.name)
                entry[channel] = score(measured, modelled).as_dict() | {"unit": unit}
            signal = "current" if m in driven else "velocity"
            entry["delay_ms"] = float(
                delay(
                    residual.filter(getattr(trial, signal)[:, m], trial.name),
                    residual.filter(getattr(response, signal)[:, m], trial.name),
                )
            )
            motors[motor] = entry
        entries.append({"name": trial.name, "role": trial.role, "motors": motors})
    return entries


def delay(measured: np.ndarray, modelled: np.ndarray) -> int:
    """Samples by which the measurement trails the model; least squares over whole samples."""
    span = min(LONGEST_DELAY, len(measured) // 4)
    middle = modelled[span : len(modelled) - span]
    lags = list(range(-span, span + 1))
    errors = [
        np.mean((measured[span + lag : len(measured) - span + lag] - middle) ** 2) for lag in lags
    ]
    return lags[int(np.argmin(errors))]


def stage(root: Path) -> None:
    """Score current, displacement and velocity, trial by trial and on average."""
    config = public_config(root)
    changes = read_json(root / "data/identified/base.json", "identify")["changes"]
    model = plant(config)
    entries = []
    for role in ("validate", "heldout"):
        entries += compare(residual(root, config, model, role), changes)
    write_json(root / "data/compare/compare.json", {"trials": entries})
    heldout = [t for t in entries if t["role"] == "heldout"]
    figures: dict[str, dict[str, float | str]] = {}
    for channel, unit in CHANNELS.items():
        # a commanded current says nothing: its motor shows its load in its motion
        motors = [m for t in heldout for m in t["motors"].values()]
        scored = [m[channel] for m in motors if m["driven"] or channel != "current"]
        means = {k: float(f"{np.mean([s[k] for s in scored]):.9g}") for k in ("mae", "rmse", "r2")}
        figures[channel] = {**means, "unit": unit}
    write_json(root / "reports/metrics/compare.json", figures)
    tell(f"held-out current RMSE {1e3 * float(figures['current']['rmse']):.1f} mA")


if __name__ == "__main__":
    entry("compare", stage, __doc__)
