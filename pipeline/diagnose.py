"""Stage `diagnose`: which effect is missing; add it, refit, and watch the error."""

from dataclasses import fields
from pathlib import Path
from typing import Any

from pipeline.model import fitted_names, plant, weighed_residuals
from pipeline.overlay import motion, overlay
from pipeline.own_effects import given
from pipeline.schema import Config
from pipeline.stage import entry, public_config, read_json, tell, write_json
from pipeline.switches import laws, switches
from spirob.diagnosis.atlas import survey
from spirob.diagnosis.document import document, metrics
from spirob.diagnosis.evidence import noise_floor
from spirob.diagnosis.followup import asked
from spirob.diagnosis.ladder import climb
from spirob.diagnosis.rungs import Ladder, Rules, Settings, floor_at
from spirob.diagnosis.verdict import Verdict, judge
from spirob.effects import all_effects, find_effects

OUT = Path("data/search")


def stage(root: Path) -> None:
    """Search, judge, and write everything that the report shows."""
    config = public_config(root)
    identified = read_json(root / "data/identified/base.json", "identify")
    chosen = config.diagnose.candidates
    candidates = find_effects(chosen) if chosen else list(all_effects().values())
    candidates = [c for c in candidates if c not in find_effects(config.plant.effects)]
    model = plant(config, candidates)
    residuals = weighed_residuals(root, config, model)
    settings = settings_of(config)
    gate = identified["gate"]
    names = [n for n in fitted_names(config) if n not in gate["silent"] + gate["held"]]
    search = climb(
        residuals,
        names,
        candidates,
        identified["changes"],
        settings,
        tell,
        measure=lambda found: floor_at(found, residuals, settings.scale),
    )
    settings = search.settings(settings)
    verdict = judge(search, residuals, settings)
    base = search.rungs[0].fit
    train, effort = residuals["train"], residuals["train"].effort
    plain = train.unweighted()
    where = survey(plain, base.changes, plain(base.changes)[plain.rows])
    question = asked(search, verdict, residuals, settings)
    noise, further = noise_floor(train), question.decide or question.prove
    written = document(search, verdict, where, noise, residuals, further)
    last = search.rungs[-1].fit.changes if verdict.kind == "named" else base.changes
    write_json(root / OUT / "diagnosis.json", written)
    write_json(root / OUT / "question.json", question.as_dict())
    write_json(root / OUT / "model.json", model_of(search, verdict, config))
    write_json(root / OUT / "metrics.json", metrics(search, verdict, effort))
    overlay(root / OUT, residuals, base.changes, last)
    motion(root / OUT, residuals, last)
    switches(root / OUT, residuals, search, settings.scale)
    laws(root / OUT, residuals, search, verdict.kind == "named")
    tell(verdict.sentence)


def settings_of(config: Config) -> Settings:
    """How the search decides, from the configuration."""
    own = {rule.name: getattr(config.diagnose, rule.name) for rule in fields(Rules)}
    return Settings(scale=config.identify.scale, **own)


def model_of(search: Ladder, verdict: Verdict, config: Config) -> dict[str, Any]:
    """The model that stands: its own effects with what was named, or without."""
    last = search.rungs[-1] if verdict.kind == "named" else search.rungs[0]
    changes = {name: float(value) for name, value in last.fit.changes.items()}
    added = given(config, [e.name() for e in last.effects])
    return {"effects": [*config.plant.effects, *added], "changes": changes}


if __name__ == "__main__":
    entry("diagnose", stage, __doc__)
