"""Stage `transfer`: size learned from three models, tested on the robot; and what intervals hold.

The models are the one before any measurement, the identified one, and the one with the named
effect; each gives the same wraps, the first of those that the shipped predictor learns from, to a
stack that chooses its numbers by them, as the shipped one does: once all played by the model
itself, and once those of drawn sizes by many builds about it, as the shipped predictor learns.
If diagnosis is worth anything, the error on the robot falls from one model to the next.  Where it
does not, the numbers tell why that stood in for the missing effect in the identified model.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from pipeline.features import features_of
from pipeline.model import plant
from pipeline.schema import Config
from pipeline.stage import entry, public_config, read_json, rounded, tell, write_json
from pipeline.train import learnt as learnt_from
from pipeline.trials import compared_wraps
from pipeline.wraps import wrapped
from spirob.parameter import Table
from spirob.perceive.interval import CONFIDENCE, coverage, estimate, supported
from spirob.perceive.model_file import load_model
from spirob.perceive.size import SizeModel, predict
from spirob.perceive.study import mean_gain, score, scored

MOVED = 1.2  # ratio from which on a fitted number stood in for the effect


def stage(root: Path) -> None:
    """Train on each model's wraps and score all on the robot's."""
    config = public_config(root)
    robot, unseen = features_of(root, "robot"), features_of(root, "unseen")
    shipped = load_model(root / "data/models/size.skops")
    wraps, named = compared_wraps(config), read_json(root / "data/diagnosis/model.json", "decide")
    models = {**_before(root, config), "named": named}
    sizes: dict[str, dict[str, np.ndarray]] = {"robot": {}}
    if config.perceive.drawn.machines > 0.0:
        sizes["machines"] = {}
    for name, model in models.items():
        for by, told in sizes.items():
            about = by == "machines"
            if about and name == "named":  # the shipped predictor's own wraps, played already
                features = features_of(root, "train")[: len(wraps)]
            else:
                features = wrapped(config, model, wraps, training=about)
            told[name] = predict(learnt_from(features, config)[0], robot)
        tell(f"learned from {len(wraps)} wraps of the {name} model")
    true = robot["diameter"].to_numpy()
    steps = {by: _steps(true, told, config.perceive.seed) for by, told in sizes.items()}
    moved = []
    if set(named["effects"]) > set(config.plant.effects):
        fitted = read_json(root / "data/identified/base.json", "identify")["parameters"]
        moved = stood_in(fitted, named["changes"], plant(config).table)
    metrics: dict[str, Any] = {
        **steps,
        "samples": len(wraps),
        "stood_in": moved,
    }
    if supported(shipped):
        metrics["interval"] = _intervals(shipped, {"simulation": unseen, "robot": robot})
    write_json(root / "reports/metrics/transfer.json", metrics)
    points = {"true": true, **sizes["robot"]}
    plain = {key: np.round(values, 7).tolist() for key, values in points.items()}
    write_json(root / "data/transfer/transfer.json", {"points": plain, **metrics})


def _before(root: Path, config: Config) -> dict[str, dict[str, Any]]:
    """The model before any measurement, and as identified, without the named effect."""
    changes = read_json(root / "data/identified/base.json", "identify")["changes"]
    own = config.plant.effects
    return {
        "nominal": {"effects": own, "changes": {}},
        "identified": {"effects": own, "changes": changes},
    }


def stood_in(
    fitted: Mapping[str, Mapping[str, Any]], named: Mapping[str, float], table: Table
) -> list[dict[str, Any]]:
    """Fitted numbers that the named effect moved by a fifth and more, at most three, most first.

    fitted  "value" and "at_bound" of what was fitted without the effect; a number left at nominal
            is not in it: no fit has moved it, so it can stand for nothing
    named   all numbers of the model with the effect
    """
    values = {n: float(one["value"]) for n, one in fitted.items()}
    both = [n for n in values if n in named and min(values[n], named[n]) > 0.0]
    moved = {n: abs(math.log(values[n] / named[n])) for n in both}
    most = sorted((n for n in both if moved[n] > math.log(MOVED)), key=lambda n: -moved[n])[:3]
    return [
        {
            "name": n,
            "meaning": table.about[n].meaning,
            "identified": float(f"{values[n]:.6g}"),
            "named": float(f"{named[n]:.6g}"),
            "unit": table.about[n].unit,
            "at_bound": bool(fitted[n]["at_bound"]),
        }
        for n in most
    ]


def _steps(true: np.ndarray, sizes: Mapping[str, np.ndarray], seed: int) -> dict[str, Any]:
    """Errors on the robot, model by model, and how much each step gains."""
    steps: dict[str, Any] = {}
    before = None
    for name, found in sizes.items():
        one = scored(true, found, seed)
        if before is not None:
            low, high = mean_gain(true, before, found, seed)
            gain = score(true, before)["mae"] - one["mae"]
            one |= {"gain": gain, "gain_low": low, "gain_high": high}
        steps[name] = {**rounded(one), "unit": "mm"}
        before = found
        tell(f"size learnt from the {name} model: {steps[name]['mae']:.2f} mm on the robot")
    return steps


def _intervals(learnt: SizeModel, tables: Mapping[str, pd.DataFrame]) -> dict[str, Any]:
    """How often the shipped model's intervals hold the true size, simulated and on the robot."""
    found = {
        domain: rounded(coverage(estimate(learnt, t), t["diameter"].to_numpy()))
        for domain, t in tables.items()
    }
    return {"confidence": CONFIDENCE, **found}


if __name__ == "__main__":
    entry("transfer", stage, __doc__)
