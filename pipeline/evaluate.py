"""Stage `evaluate`: object size on unseen sizes and on the robot; then the verdict's score.

Only here is the truth opened, after everything has been decided.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from pipeline.stage import public_config, read_json, run, tell, write_json
from spirob.errors import MissingLog
from spirob.logs.atomic import replacing
from spirob.perceive.model_file import load_model
from spirob.perceive.score import score
from spirob.perceive.size import PREDICTORS, predict
from spirob.trial.answers import right


def stage(root: Path) -> None:
    """Score both, and keep every prediction for the report."""
    _size(root)
    _verdict(root)


def _size(root: Path) -> None:
    shipped = public_config(root).perceive.predictor
    model = load_model(root / "data/models/size.joblib")
    metrics: dict[str, dict[str, object]] = {}
    rows = []
    for domain, name in (("simulation", "unseen"), ("robot", "robot")):
        path = root / f"data/features/{name}.parquet"
        if not path.exists():
            raise MissingLog(f"{path} is missing; the stage 'features' writes it")
        features = pd.read_parquet(path)
        true = features["diameter"].to_numpy()
        by_predictor = {p: predict(model, features, p) for p in PREDICTORS}
        others = {
            p: _rounded(score(true, values)) for p, values in by_predictor.items() if p != shipped
        }
        mean = _rounded(score(true, np.full(len(true), float(np.mean(true)))))
        metrics[domain] = {
            **_rounded(score(true, by_predictor[shipped])),
            "unit": "mm",
            "samples": len(true),
            "other": others | {"mean": mean},
        }
        columns = {"true_mm": 1e3 * true, "predicted_mm": 1e3 * by_predictor[shipped]}
        rows.append(pd.DataFrame({"domain": domain, **columns}))
        tell(f"size, {domain}: MAE {metrics[domain]['mae']:.2f} mm, R2 {metrics[domain]['r2']:.3f}")
    with replacing(root / "data/features/predictions.parquet") as temporary:
        pd.concat(rows, ignore_index=True).to_parquet(temporary, compression="zstd", index=False)
    write_json(root / "reports/metrics/size.json", metrics)


def _verdict(root: Path) -> None:
    truth = read_json(root / "data/truth/truth.json", "collect")
    said = read_json(root / "reports/metrics/diagnose.json", "diagnose")
    hidden = str(truth.get("effect", ""))
    content = {
        "hidden": hidden,
        "named": said["effect"],
        "verdict": said["verdict"],
        "verdict_right": right(hidden, said["effect"]) if hidden else None,
    }
    write_json(root / "reports/metrics/score.json", content)


def _rounded(values: dict[str, float]) -> dict[str, float]:
    return {k: float(f"{v:.9g}") for k, v in values.items()}


if __name__ == "__main__":
    run("evaluate", stage)
