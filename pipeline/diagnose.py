"""Stage `diagnose`: which effect is missing; add it, refit, and watch the error."""

from dataclasses import fields
from pathlib import Path
from typing import Any

from pipeline.model import fitted_names, plant, weighed_residuals
from pipeline.overlay import laws, motion, overlay, switches
from pipeline.own_effects import given
from pipeline.schema import Config
from pipeline.stage import entry, public_config, read_json, tell, write_json
from spirob.diagnosis.atlas import survey
from spirob.diagnosis.certainty import Ended
from spirob.diagnosis.criteria import ArmCriteria, Settings, floor_at, noise_floor
from spirob.diagnosis.document import document, metrics
from spirob.diagnosis.fitting import begun
from spirob.diagnosis.followup import asked
from spirob.diagnosis.schema import checked
from spirob.diagnosis.simulated import Simulated
from spirob.diagnosis.verdict import Verdict, searched
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
    models = Simulated(
        residuals,
        names,
        settings,
        begun(residuals["train"], names, identified["changes"], settings),
        lambda found: floor_at(found, residuals, settings.scale),
    )
    ended, verdict = searched(models, candidates, settings, tell)
    found = ended.found
    base, last = found.rungs[0].fit, found.chosen.fit
    plain = residuals["train"].unweighted()
    where = survey(plain, base.changes, plain(base.changes)[plain.rows])
    question = asked(ended, verdict)
    noise, further = noise_floor(residuals["train"]), question.decide or question.prove
    named = verdict.kind == "named"
    written = checked(document(ended, verdict, where, noise, further))
    write_json(root / OUT / "diagnosis.json", written)
    write_json(root / OUT / "question.json", question.as_dict())
    write_json(root / OUT / "model.json", model_of(ended, verdict, config))
    write_json(root / OUT / "metrics.json", metrics(ended, verdict))
    stands = last.changes if named else base.changes
    overlay(root / OUT, residuals, base.changes, stands)
    motion(root / OUT, residuals, stands)
    switches(root / OUT, models, found)
    laws(root / OUT, models, found, named)
    tell(verdict.sentence)


def settings_of(config: Config) -> Settings:
    """How the search decides, from the configuration."""
    own = {rule.name: getattr(config.diagnose, rule.name) for rule in fields(ArmCriteria)}
    return Settings(scale=config.identify.scale, **own)


def model_of(ended: Ended, verdict: Verdict, config: Config) -> dict[str, Any]:
    """The model that stands: its own effects with what was named, or without."""
    last = ended.found.rungs[-1 if verdict.kind == "named" else 0]
    changes = {name: float(value) for name, value in last.fit.changes.items()}
    added = given(config, [e.name() for e in last.effects])
    return {"effects": [*config.plant.effects, *added], "changes": changes}


if __name__ == "__main__":
    entry("diagnose", stage, __doc__)
