"""A finished run that never happened: every file the report reads, with plausible numbers."""

import json
from itertools import combinations as subsets
from pathlib import Path

import numpy as np
import pandas as pd

from tests.report.synthetic_results import (
    DIAGNOSIS,
    IDENTIFIED,
    TRIAL,
    contacts,
    experiments,
    passive,
    size,
    transfer,
)

TRIALS = {
    "hysteresis_left": ("heldout", ("left",)),
    "extreme_curl": ("heldout", ("left", "right")),
    "crawl_3_mm_s": ("heldout", ("right",)),
    "antagonist_hold": ("validate", ("left", "right")),
    "excitation_1": ("train", ("left", "right")),
    "excitation_2": ("train", ("left", "right")),
}
DURATION, RATE, FRAMES = 24.0, 100.0, 30.0  # s, Hz, Hz
CHANNELS = {"current": "A", "displacement": "m", "velocity": "m/s"}


def write_run(root: Path, optional: bool = True) -> Path:
    """Write all sources under `root`; without `optional`, only the required ones."""
    rng = np.random.default_rng(7)
    _text(root, "data/config/config.yaml", CONFIG)
    overlay = _overlay(rng)
    _json(root, "data/identified/base.json", IDENTIFIED)
    _json(root, "data/compare/compare.json", _compare(overlay))
    _json(root, "data/diagnosis/diagnosis.json", DIAGNOSIS)
    _table(root, "data/diagnosis/overlay.parquet", overlay)
    _json(root, "reports/metrics/identify.json", {"train": IDENTIFIED["train"]})
    _json(root, "reports/metrics/compare.json", {"heldout": {"rmse": 0.1834, "r2": 0.871}})
    _json(root, "reports/metrics/diagnose.json", {"probability": 0.93, "verdict": "named"})
    if optional:
        _optional(root, rng, overlay)
    return root


def _optional(root: Path, rng: np.random.Generator, overlay: pd.DataFrame) -> None:
    _table(root, "data/diagnosis/motion.parquet", _motion())
    _table(root, "data/diagnosis/combinations.parquet", _combinations(overlay))
    _table(root, "data/diagnosis/laws.parquet", _laws(overlay))
    _table(root, "data/diagnosis/composed.parquet", composed())
    _json(root, "reports/metrics/trial_full.json", TRIAL)
    _table(root, "data/truth/posture/hysteresis_left.parquet", _posture())
    _table(root, "data/features/predictions.parquet", _predictions(rng))
    _json(root, "reports/metrics/size.json", size())
    _json(root, "reports/metrics/contacts.json", contacts())
    _json(root, "reports/metrics/passive.json", passive())
    _json(root, "reports/metrics/score.json", {"hidden": "capstan friction", "verdict_right": True})
    _json(root, "data/experiments/experiments.json", experiments())
    _json(root, "data/transfer/transfer.json", transfer())
    rows = [[f"guide_{k}", 0.1 * k, 0.18 / (1 + k), k % 2 == 0] for k in range(5)]
    columns = ["hidden", "friction [1]", "held-out RMSE [A]", "right"]
    _json(root, "data/sweep/table.json", {"columns": columns, "rows": rows})


def _overlay(rng: np.random.Generator) -> pd.DataFrame:
    parts = []
    time = np.arange(0, DURATION, 1 / RATE)
    for k, (trial, (role, driven)) in enumerate(TRIALS.items()):
        for motor in ("left", "right"):
            pulls = motor in driven
            phase = 2 * np.pi * time / (6 + k) + (motor == "right") * np.pi
            stroke = 0.05 * (1 - np.cos(phase)) * (1 if pulls else 0.04)
            speed = np.gradient(stroke, time)
            load = 12 * stroke + 0.25
            friction = 0.22 * np.tanh(speed / 2e-3) * load / 0.8
            noise = 0.012 * rng.standard_normal(time.size)
            truth = load + friction + 0.05 * np.sin(3.1 * phase)
            parts.append(
                pd.DataFrame(
                    {
                        "trial": trial,
                        "role": role,
                        "motor": motor,
                        "time": time,
                        "measured_current": truth + noise,
                        "base_current": load * 1.05 + 0.02 * np.tanh(speed / 2e-2),
                        "named_current": truth - 0.045 * np.sin(3.1 * phase),
                        "measured_displacement": stroke + 2e-5 * rng.standard_normal(time.size),
                        "base_displacement": np.interp(time - 0.05, time, stroke),
                        "named_displacement": np.interp(time - 0.01, time, stroke),
                        "measured_velocity": speed + 4e-4 * rng.standard_normal(time.size),
                        "base_velocity": np.interp(time - 0.05, time, speed),
                        "named_velocity": np.interp(time - 0.01, time, speed),
                    }
                )
            )
    return pd.concat(parts, ignore_index=True)


def _compare(overlay: pd.DataFrame) -> dict:
    trials = []
    for trial, (role, driven) in TRIALS.items():
        motors = {}
        for motor in ("left", "right"):
            rows = overlay[(overlay.trial == trial) & (overlay.motor == motor)]
            errors = {
                channel: _errors(rows[f"measured_{channel}"], rows[f"base_{channel}"], unit)
                for channel, unit in CHANNELS.items()
            }
            motors[motor] = {"driven": motor in driven, **errors, "delay_ms": 51.2}
        trials.append({"name": trial, "role": role, "motors": motors})
    return {"trials": trials}


def _errors(measured: pd.Series, modelled: pd.Series, unit: str) -> dict:
    difference = measured - modelled
    return {
        "mae": float(difference.abs().mean()),
        "rmse": float((difference**2).mean() ** 0.5),
        "r2": float(1 - (difference**2).sum() / ((measured - measured.mean()) ** 2).sum()),
        "unit": unit,
    }


def _motion() -> pd.DataFrame:
    parts = []
    time = np.arange(0, DURATION, 1 / FRAMES)
    for k, trial in enumerate(TRIALS):
        bend = np.sin(2 * np.pi * time / (6 + k))
        # the slender tip curls before the base does
        share = np.linspace(0.12, 0.46, 24)
        angles = 0.5 * np.tanh(np.outer(bend, share) / 0.3)
        frame = pd.DataFrame(angles, columns=[f"q{i}" for i in range(24)])
        parts.append(frame.assign(trial=trial, time=time))
    return pd.concat(parts, ignore_index=True)


SHARES = {"capstan_friction": 0.9, "coulomb_friction": 0.4, "cogging": -0.1}


def _combinations(overlay: pd.DataFrame) -> pd.DataFrame:
    """Each combination takes its own share of what the named model changes."""
    parts = []
    for count in (1, 2, 3):
        for chosen in subsets(SHARES, count):
            how = "replayed" if count > 1 else "screened" if "cogging" in chosen else "refitted"
            about = {"effects": " + ".join(chosen), "how": how}
            rows = overlay[["trial", "role", "motor", "time"]].assign(**about)
            for channel in CHANNELS:
                base = overlay[f"base_{channel}"]
                change = overlay[f"named_{channel}"] - base
                rows[channel] = base + sum(SHARES[name] for name in chosen) * change
            parts.append(rows)
    return pd.concat(parts, ignore_index=True)


def _laws(overlay: pd.DataFrame) -> pd.DataFrame:
    rows = overlay[["trial", "role", "motor", "time"]].assign(effect="capstan_friction")
    for name, side in (("with", "named"), ("without", "base")):
        rows[f"{name}_current"] = overlay[f"{side}_current"]
    return rows


def composed() -> pd.DataFrame:
    """A law of the place over what is left."""
    x = np.linspace(0.0, 0.05, 50)
    columns = {"effect": "law", "axis": "m", "position": x, "velocity": 0.01, "time": x}
    columns |= {"effort": 0.5, "shown": 0.02 * np.sin(100.0 * x), "law": 0.02, "band": 0.002}
    return pd.DataFrame(columns)


def _posture() -> pd.DataFrame:
    """The robot has 48 hinges, and bends a tenth less than the model does."""
    model = _motion()
    model = model[model["trial"] == "hysteresis_left"]
    columns = {f"q{2 * i + k}": 0.45 * model[f"q{i}"] for i in range(24) for k in (0, 1)}
    return pd.DataFrame({"trial": "hysteresis_left", "time": model["time"]} | columns)


def _predictions(rng: np.random.Generator) -> pd.DataFrame:
    parts = []
    for domain, count, spread in (("simulation", 35, 1.7), ("robot", 28, 4.3)):
        true = np.tile(np.arange(10.0, 71.0, 10.0), -(-count // 7))[:count]
        predicted = true + spread * rng.standard_normal(count)
        parts.append(pd.DataFrame({"domain": domain, "true_mm": true, "predicted_mm": predicted}))
    return pd.concat(parts, ignore_index=True)


def _text(root: Path, path: str, content: str) -> None:
    (root / path).parent.mkdir(parents=True, exist_ok=True)
    (root / path).write_text(content, encoding="utf-8")


def _json(root: Path, path: str, content: dict) -> None:
    _text(root, path, json.dumps(content, indent=2))


def _table(root: Path, path: str, content: pd.DataFrame) -> None:
    (root / path).parent.mkdir(parents=True, exist_ok=True)
    content.to_parquet(root / path)


CONFIG = """rig:
  name: spirob
  gear_ratio: 19.203
recordings:
  seed: 7
  trials: 6
diagnose:
  seed: 11
  least_gain: 0.02
"""
