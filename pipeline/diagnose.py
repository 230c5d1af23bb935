"""Stage `diagnose`: which effect is missing; add it, refit, and watch the error."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pipeline.model import fitted_names, plant, residual
from pipeline.overlay import motion, overlay
from pipeline.schema import Config
from pipeline.stage import entry, public_config, read_json, tell, write_json
from pipeline.switches import laws, switches
from spirob.diagnosis.again import proposed
from spirob.diagnosis.contest import in_question
from spirob.diagnosis.document import document, metrics
from spirob.diagnosis.ladder import climb
from spirob.diagnosis.noise import noise_floor
from spirob.diagnosis.proof import FOUND, to_prove
from spirob.diagnosis.proposals import Proposal
from spirob.diagnosis.rungs import Search, Settings
from spirob.diagnosis.survey import survey
from spirob.diagnosis.verdict import Verdict, judge
from spirob.effects import all_effects, find_effects
from spirob.identify.sense import refuse_senseless

OUT = Path("data/search")


def stage(root: Path) -> None:
    """Search, judge, and write everything that the report shows."""
    config = public_config(root)
    identified = read_json(root / "data/identified/base.json", "identify")
    chosen = config.diagnose.candidates
    candidates = find_effects(chosen) if chosen else list(all_effects().values())
    candidates = [c for c in candidates if c not in find_effects(config.plant.effects)]
    model = plant(config, candidates)
    residuals = {r: residual(root, config, model, r) for r in ("train", "validate", "heldout")}
    for role in ("validate", "heldout"):  # the stage `identify` asked it of those that are fitted
        refuse_senseless(residuals[role], residuals[role](identified["changes"]))
    settings = settings_of(config)
    gate = identified["gate"]
    names = [n for n in fitted_names(config) if n not in gate["silent"] + gate["held"]]
    search = climb(residuals, names, candidates, identified["changes"], settings, tell)
    verdict = judge(search, residuals, settings)
    base = search.rungs[0].fit
    train, effort = residuals["train"], residuals["train"].effort
    where = survey(train, base.changes, base.residual[train.rows])
    contested = proposed(search, verdict, residuals["validate"], settings)
    proofs = to_prove(search, residuals["validate"], settings) if verdict.kind in FOUND else []
    floor, further = noise_floor(train), contested or proofs
    written = document(search, verdict, where, floor, residuals, further)
    last = search.rungs[-1].fit.changes if verdict.kind == "named" else base.changes
    write_json(root / OUT / "diagnosis.json", written)
    write_json(root / OUT / "contest.json", _contest(search, verdict, contested, proofs))
    write_json(root / OUT / "model.json", model_of(search, verdict))
    write_json(root / OUT / "metrics.json", metrics(search, verdict, effort))
    overlay(root / OUT, residuals, base.changes, last)
    motion(root / OUT, residuals, last)
    switches(root / OUT, residuals, search, settings.scale)
    laws(root / OUT, residuals, search, verdict.kind == "named")
    tell(verdict.sentence)


def settings_of(config: Config) -> Settings:
    """How the search decides, from the configuration."""
    own = config.diagnose.model_dump(exclude={"candidates"})
    return Settings(scale=config.identify.scale, **own)


def model_of(search: Search, verdict: Verdict) -> dict[str, Any]:
    """The model that stands: with what was named, or the fitted one without."""
    last = search.rungs[-1] if verdict.kind == "named" else search.rungs[0]
    changes = {name: float(value) for name, value in last.fit.changes.items()}
    return {"effects": [e.name() for e in last.effects], "changes": changes}


def _contest(
    search: Search, verdict: Verdict, contested: Sequence[Proposal], proofs: Sequence[Proposal]
) -> dict[str, Any]:
    """What is left to play: the trials that would decide between what was found and those beside
    it, the one that would prove a name, and the models in question."""
    models = in_question(search, verdict) if contested or proofs else ()
    return {**_first(contested), "proof": _first(proofs), "models": [m.as_dict() for m in models]}


def _first(further: Sequence[Proposal]) -> dict[str, Any]:
    """The best experiment and its trials; empty where there is none."""
    best = further[0] if further else None
    return {"experiment": best.name if best else "", "trials": list(best.trials) if best else []}


if __name__ == "__main__":
    entry("diagnose", stage, __doc__)
