"""Stage `decide`: judge again with the trials that were asked for; the diagnosis that stands.

Names that do not hold under a softer pull are taken away; where something is missing that has no
name, a law is composed.  Where nothing was asked, nothing could be played, or what was played tells
nothing of those in question, the diagnosis stands as it is.  The law lies beside the diagnosis:
`law.py`, an effect like any other, and composed.parquet, its drawing.
"""

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from pipeline.diagnose import model_of, settings_of
from pipeline.model import plant, weighed_residuals
from pipeline.overlay import laws, motion, overlay, write_table
from pipeline.own_effects import given, lay_beside
from pipeline.schema import Config
from pipeline.stage import ASKED, entry, public_config, read_json, tell, write_json
from spirob.diagnosis import schema
from spirob.diagnosis.atlas import KEYS
from spirob.diagnosis.criteria import Settings, noise_floor
from spirob.diagnosis.document import CEILING, document, metrics, restated
from spirob.diagnosis.followup import FOUND, Answer, Question, answered
from spirob.diagnosis.proposals import Proposal
from spirob.files import write_text
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual
from spirob.logs import read_log
from spirob.machine.composed.arm import Rival, composed_for_arm

SEARCH, OUT = Path("data/search"), Path("data/diagnosis")
NAMELESS = {"effect": "", "effects": "", "probability": 0.0}  # metrics where a name fell


def stage(root: Path) -> None:
    """Write data/diagnosis and its metrics."""
    config = public_config(root)
    before = schema.read(root / SEARCH / "diagnosis.json")
    found = read_json(root / SEARCH / "metrics.json", "diagnose")
    asked = read_json(root / SEARCH / "question.json", "diagnose")
    for model in asked["models"]:
        model["effects"] = given(config, model["effects"])
    question = Question.from_dict(asked)
    shutil.copytree(root / SEARCH, root / OUT, dirs_exist_ok=True)
    lay_beside(root, config, OUT)
    told, settings = before, replace(settings_of(config), floor=before["floor"]["share"])
    if any(_played(root, one) for one in question.wanted):
        model = plant(config, list(dict.fromkeys(e for m in question.models for e in m.effects)))
        own = weighed_residuals(root, config, model)
        answer = answered(question, own, lambda one: _played(root, one), settings)
        told = _told(answer, before, own)
        _model(root, answer, before["verdict"], own, config)
        if answer.ended:
            found = metrics(answer.ended, answer.verdict)
        elif answer.verdict.kind != found["verdict"]:
            found |= {"verdict": answer.verdict.kind, **NAMELESS}
    if told["verdict"] == "unknown":
        changes = read_json(root / OUT / "model.json", "diagnose")["changes"]
        told = {**told, "composed": composed(root, config, settings, told, changes)}
    write_json(root / OUT / "diagnosis.json", schema.checked(told))
    write_json(root / "reports/metrics/diagnose.json", found)


def _played(root: Path, experiment: Proposal) -> dict[str, list[Measurement]]:
    """The logs of an experiment by role; none where it was not played, or not to its end."""
    logs = {root / ASKED / f"{t['name']}.mcap": t["role"] for t in experiment.trials}
    found: dict[str, list[Measurement]] = {}
    if all(log.exists() for log in logs):
        for log, role in logs.items():
            found.setdefault(role, []).append(Measurement.from_trace(read_log(log)))
    return found


def _told(answer: Answer, before: Mapping[str, Any], own: Mapping[str, Residual]) -> dict[str, Any]:
    """The diagnosis from now on."""
    if answer.ended:
        where = {key: before[key] for key in KEYS if key in before}
        floor = noise_floor(own["train"])
        found = document(answer.ended, answer.verdict, where, floor)
        found |= {key: before[key] for key in ("vague", "floor")}
    else:
        found = restated(before, answer.verdict, answer.aside)
    if answer.experiment:
        aside = {"aside": True} if answer.aside else {}
        asked = {"experiment": answer.experiment, "before": before["sentence"]}
        found["asked"] = asked | aside
        tell(f"after '{answer.experiment}': {'it does not tell which' if aside else 'decided'}")
    if answer.proof:
        found["proof"] = {**asdict(answer.proof), "holds": answer.verdict.kind in FOUND}
        share = answer.proof.share
        tell(f"'{answer.proof.experiment}' shows {share:.0%} of the squared error explained")
    tell(answer.verdict.sentence)
    return found


def _model(
    root: Path, answer: Answer, before: str, own: Mapping[str, Residual], config: Config
) -> None:
    """The model that stands, and what it does in the trials, beside the one without any effect."""
    if not answer.ended and answer.verdict.kind == before:
        return
    base = dict(answer.models[0].changes)
    stands: dict[str, Any] = {"effects": config.plant.effects, "changes": base}
    if answer.ended:
        stands = model_of(answer.ended, answer.verdict, config)
        if answer.verdict.kind == "named":
            laws(root / OUT, answer.ended.search.models, answer.ended.found, True)
    write_json(root / OUT / "model.json", stands)
    overlay(root / OUT, own, base, stands["changes"])
    motion(root / OUT, own, stands["changes"])


ROLES = ("train", "validate", "heldout")


def composed(
    root: Path,
    config: Config,
    settings: Settings,
    told: Mapping[str, Any],
    changes: Mapping[str, float],
) -> dict[str, Any] | None:
    """A law for what the library lacks: what the document says of it, None where none holds.

    settings  with the floor of the machine
    told  the diagnosis that stands;  changes  numbers of its model
    """
    own = weighed_residuals(root, config, plant(config))
    fitted = read_json(root / "data/identified/base.json", "identify")["parameters"]
    names = [name for name in fitted if name not in told["vague"]]
    law = composed_for_arm(own, names, changes, _rival(told["ladder"]), settings, tell)
    if law is None:
        tell("no law of a few terms takes what is left")
        return None
    write_text(root / OUT / law.document["file"], law.text)
    write_table(root / OUT / "composed.parquet", law.drawing)
    tell(law.document["sentence"])
    return law.document


def _rival(ladder: Sequence[Mapping[str, Any]]) -> Rival:
    """The best that the search found."""
    rungs = [rung for rung in ladder if rung["label"] != CEILING]
    best = min(rungs, key=lambda rung: float(rung["validate"]["rmse"]))
    errors = {role: float(best[role]["rmse"]) for role in ROLES}
    return Rival(errors, len(best["effects"]))


if __name__ == "__main__":
    entry("decide", stage, __doc__)
