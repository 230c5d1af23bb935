"""Stage `identify`: fit the model's numbers to the training trials."""

from pathlib import Path
from typing import Any

import numpy as np

from pipeline.model import fitted_names, plant, residual, start
from pipeline.stage import entry, public_config, tell, write_json
from spirob.identify.fit import Fit, best_start, block_covariance, fit_identifiable, polished
from spirob.identify.identifiability import probe
from spirob.identify.intervals import score, with_bounds
from spirob.identify.problem import Problem
from spirob.identify.residual import near, refuse_senseless
from spirob.identify.scaling import Scaling


def stage(root: Path) -> None:
    """Probe, fit, and write the numbers with their intervals."""
    config = public_config(root)
    model = plant(config)
    train = residual(root, config, model, "train")
    names, begin = fitted_names(config), start(config)
    weighed = any(trial.scene.weights for trial in train.trials)
    gate = probe(train, names, begin, weighed)
    tell(gate.sentence)
    names = [n for n in names if n not in gate.silent + gate.held]
    settings = config.identify
    begin = best_start(near(train, begin), names, begin, settings.scale, settings.starts)
    found, vague = fit_identifiable(train, names, begin, settings.scale, settings.iterations, tell)
    found = polished(train, found, settings.scale)
    refuse_senseless(train, found.residual)
    measured = train.measured()[train.rows]
    quality = score(measured, measured + found.residual[train.rows]).as_dict() | {"unit": "A"}
    sentence = gate.sentence
    if vague:
        sentence += f" Left at nominal, because the data do not tell: {', '.join(vague)}."
    parameters = with_bounds(found.estimates, model.table)
    write_json(
        root / "data/identified/base.json",
        {
            "parameters": parameters,
            "changes": found.changes,
            "vague": vague,
            "identifiability": sentence,
            "condition": gate.condition,
            "gate": gate.plain() | {"known_weight": weighed, "unit": train.effort.unit},
            "resolution": resolution(found, train, settings.scale),
            "train": quality,
        },
    )
    shown = ("value", "low", "high", "unit")
    figures = {k: {f: v[f] for f in shown} for k, v in parameters.items()}
    said = {"sentence": sentence, "null": len(gate.null), "known_weight": weighed}
    write_json(
        root / "reports/metrics/identify.json",
        {"train": quality, "parameters": figures, "identifiability": said},
    )


TENTH = 0.1  # a change of about ten per cent


def resolution(found: Fit, residual: Problem, scale: float) -> dict[str, Any]:
    """How well the data resolve the fitted numbers, of a fit with its exact slopes.

    A step of one is a factor of e for a number that spans decades and its nominal size for others.

    correlation  (n, n) of the fitted numbers, from the covariance that gives their intervals
    weakest      unit combination that moves the effort least, by number
    least, most  RMS change of the effort for a tenth along the weakest and the strongest
                 combination, in its unit
    """
    names = list(found.estimates)
    scaling = Scaling(residual.table, names)
    slopes = scaling.relative(scaling.scaled(found.changes))
    covariance = block_covariance(
        found.jacobian, found.residual, residual.edges, scale, residual.block
    )
    covariance = slopes @ covariance @ slopes.T
    deviation = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    correlation = np.clip(covariance / np.outer(deviation, deviation), -1.0, 1.0)
    _, singular, rows = np.linalg.svd(found.jacobian @ np.linalg.inv(slopes), full_matrices=False)
    weakest = rows[-1] * np.sign(rows[-1][np.argmax(np.abs(rows[-1]))])
    size = TENTH / np.sqrt(len(found.residual))
    return {
        "names": names,
        "correlation": [[float(f"{v:.4g}") for v in row] for row in correlation],
        "weakest": {n: float(f"{v:.4g}") for n, v in zip(names, weakest, strict=True)},
        "least": float(f"{size * singular[-1]:.6g}"),
        "most": float(f"{size * singular[0]:.6g}"),
        "unit": residual.effort.unit,
    }


if __name__ == "__main__":
    entry("identify", stage, __doc__)
