"""Stage `identify`: fit the model's numbers to the training trials."""

from pathlib import Path
from typing import Any

from pipeline.model import fitted_names, plant, residual, start
from pipeline.resolution import resolution
from pipeline.stage import entry, public_config, tell, write_json
from spirob.identify.fit import Fit, best_start, fit_identifiable, polished
from spirob.identify.identifiability import probe
from spirob.identify.plausibility import refuse_senseless
from spirob.identify.residual import near
from spirob.parameter import Table
from spirob.score import score


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
    parameters = described(found, model.table)
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


def described(found: Fit, table: Table) -> dict[str, Any]:
    """Fitted numbers with what is known of them beforehand."""
    out = {}
    for name, estimate in found.estimates.items():
        about = table.about[name]
        low, high = about.reach(float(table.values[table.position(name)]))
        out[name] = {
            "value": estimate.value,
            "low": estimate.low,
            "high": estimate.high,
            "unit": about.unit,
            "nominal": about.nominal,
            "bound_low": low,
            "bound_high": high,
            "at_bound": estimate.at_bound,
            "meaning": about.meaning,
        }
    return out


if __name__ == "__main__":
    entry("identify", stage, __doc__)
