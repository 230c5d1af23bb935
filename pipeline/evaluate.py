"""Stage `evaluate`: object size on unseen sizes and on the robot; then the verdict's score.

Only here is the truth opened, after everything has been decided.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from pipeline.features import features_of
from pipeline.stage import entry, read_json, rounded, tell, write_json
from pipeline.train import CHOICE
from spirob.campaign.arm.rates import right
from spirob.files import replacing
from spirob.perceive.model_file import load_model
from spirob.perceive.size import TARGET, predict
from spirob.perceive.study import importance, learning_curve, mean_gain, rivals, scored


def stage(root: Path) -> None:
    """Score both, and keep every prediction for the report."""
    _size(root)
    _verdict(root)


def _size(root: Path) -> None:
    model = load_model(root / "data/models/size.skops")
    known, listed = features_of(root, "train"), features_of(root, "paper")
    tests = {"simulation": features_of(root, "unseen"), "robot": features_of(root, "robot")}
    metrics: dict[str, dict[str, Any]] = {}
    rows = []
    others = rivals(model, known, listed)
    for domain, features in tests.items():
        true, found = features[TARGET].to_numpy(), predict(model, features)
        metrics[domain] = {
            **rounded(scored(true, found)),
            "unit": "mm",
            "samples": len(true),
            "other": {name: rival(true, other(features), found) for name, other in others.items()},
        }
        columns = {"true_mm": 1e3 * true, "predicted_mm": 1e3 * found}
        rows.append(pd.DataFrame({"domain": domain, **columns}))
        if domain == "robot":
            metrics[domain] |= unlisted(features, found, listed)
        tell(f"size, {domain}: MAE {metrics[domain]['mae']:.2f} mm, R2 {metrics[domain]['r2']:.3f}")
    curve = learning_curve(known, tests, model.settings, model.predictor)
    metrics["training"] = {
        "samples": len(known),
        "chosen": read_json(root / CHOICE, "train")["tried"],
        "importance": rounded(importance(model, tests["simulation"])),
        "learning_curve": {
            str(n): {domain: rounded(one) for domain, one in errors.items()}
            for n, errors in curve.items()
        },
        "unit": "mm",
    }
    with replacing(root / "data/features/predictions.parquet") as temporary:
        pd.concat(rows, ignore_index=True).to_parquet(temporary, compression="zstd", index=False)
    write_json(root / "reports/metrics/size.json", metrics)


def rival(true: np.ndarray, found: np.ndarray, shipped: np.ndarray) -> dict[str, float]:
    """Errors of another predictor, and what the shipped one gains over it on the same wraps [mm].

    true, found, shipped  diameters (n,) [m]
    """
    errors = scored(true, found)
    low, high = mean_gain(true, found, shipped)
    gain = errors["mae"] - scored(true, shipped)["mae"]
    return rounded({**errors, "gain": gain, "gain_low": low, "gain_high": high})


def unlisted(
    wraps: pd.DataFrame, found: np.ndarray, listed: pd.DataFrame
) -> dict[str, dict[str, Any]]:
    """Errors on the wraps whose diameter the training does not list, as {"unlisted": ...}.

    Drawn wraps lie about every diameter; only of the listed ones has it several just as large.
    Empty where all diameters are listed, or none.
    """
    true, known = wraps[TARGET].to_numpy(float), listed[TARGET].to_numpy(float)
    new = ~np.isclose(true[:, None], known[None, :], rtol=1e-6, atol=0.0).any(axis=1)
    if new.all() or not new.any():
        return {}
    errors = rounded(scored(true[new], found[new]))
    return {"unlisted": {**errors, "unit": "mm", "samples": int(new.sum())}}


def _verdict(root: Path) -> None:
    truth = read_json(root / "data/truth/truth.json", "collect")
    said = read_json(root / "reports/metrics/diagnose.json", "decide")
    hidden = str(truth.get("effect", ""))
    content = {
        "hidden": hidden,
        "named": said["effect"],
        "verdict": said["verdict"],
        "verdict_right": right(hidden, said["effect"]) if hidden else None,
    }
    write_json(root / "reports/metrics/score.json", content)


if __name__ == "__main__":
    entry("evaluate", stage, __doc__)
