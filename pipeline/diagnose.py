"""Stage `diagnose`: which effect is missing; add it, refit, and watch the error."""

from pathlib import Path

import numpy as np

from pipeline.model import fitted_names, plant, residual
from pipeline.overlay import motion, overlay
from pipeline.stage import public_config, read_json, run, tell, write_json
from pipeline.switches import laws, switches
from spirob.diagnose.again import proposed
from spirob.diagnose.atlas import atlas
from spirob.diagnose.document import document, metrics
from spirob.diagnose.ladder import climb
from spirob.diagnose.noise import noise_floor
from spirob.diagnose.rungs import Settings
from spirob.diagnose.verdict import judge
from spirob.effects import all_effects, find_effects


def stage(root: Path) -> None:
    """Search, judge, and write everything that the report shows."""
    config = public_config(root)
    identified = read_json(root / "data/identified/base.json", "identify")
    chosen = config.diagnose.candidates
    candidates = find_effects(chosen) if chosen else list(all_effects().values())
    candidates = [c for c in candidates if c not in find_effects(config.plant.effects)]
    model = plant(config, candidates)
    residuals = {r: residual(root, config, model, r) for r in ("train", "validate", "heldout")}
    own = config.diagnose.model_dump(exclude={"candidates"})
    settings = Settings(scale=config.identify.scale, **own)
    gate = identified["gate"]
    names = [n for n in fitted_names(config) if n not in gate["silent"] + gate["held"]]
    search = climb(residuals, names, candidates, identified["changes"], settings, tell)
    verdict = judge(search, residuals["validate"], settings)
    base = search.rungs[0].fit
    effort = residuals["train"].effort
    regimes = atlas(residuals["train"], base.residual[residuals["train"].rows])
    further = proposed(search, verdict, residuals["validate"])
    written = document(search, verdict, regimes, noise_floor(residuals["train"]), effort, further)
    last = search.rungs[-1] if verdict.kind == "named" else search.rungs[0]
    write_json(root / "data/diagnosis/diagnosis.json", written)
    write_json(
        root / "data/diagnosis/model.json",
        {"effects": [e.name() for e in last.effects], "changes": _set(last.fit.changes)},
    )
    overlay(root, residuals, base.changes, last.fit.changes)
    motion(root, residuals, last.fit.changes)
    switches(root, residuals, search, settings.scale)
    laws(root, residuals, search, verdict.kind == "named")
    write_json(root / "reports/metrics/diagnose.json", metrics(search, verdict, effort))
    tell(verdict.sentence)


def _set(changes: dict[str, float]) -> dict[str, float]:
    return {name: float(np.float64(value)) for name, value in changes.items()}


if __name__ == "__main__":
    run("diagnose", stage)
