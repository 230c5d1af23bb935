"""Stage `decide`: judge again with the trials that were asked for; the diagnosis that stands.

Where nothing was asked, nothing could be played, or what was played tells nothing of those in
question, the diagnosis stands as it is.
"""

import shutil
from pathlib import Path
from typing import Any

from pipeline.diagnose import model_of, settings_of
from pipeline.model import plant, residual
from pipeline.overlay import motion, overlay
from pipeline.schema import Config
from pipeline.stage import ASKED, public_config, read_json, run, tell, write_json
from pipeline.switches import laws
from spirob.diagnose.again import decided_again, joined
from spirob.diagnose.contest import Contestant
from spirob.diagnose.document import document, metrics
from spirob.diagnose.noise import noise_floor
from spirob.diagnose.verdict import judge
from spirob.identify.measurement import Measurement
from spirob.logs import read_log

SEARCH, OUT = Path("data/search"), Path("data/diagnosis")


def stage(root: Path) -> None:
    """Write data/diagnosis and its metrics."""
    config = public_config(root)
    read_json(root / SEARCH / "diagnosis.json", "diagnose")
    shutil.copytree(root / SEARCH, root / OUT, dirs_exist_ok=True)
    contest = read_json(root / SEARCH / "contest.json", "diagnose")
    found = read_json(root / SEARCH / "metrics.json", "diagnose")
    logs = [root / ASKED / f"{t['name']}.mcap" for t in contest["trials"]]
    if logs and all(log.exists() for log in logs):
        found = _again(root, config, contest, logs) or found
    write_json(root / "reports/metrics/diagnose.json", found)


def _again(
    root: Path, config: Config, contest: dict[str, Any], logs: list[Path]
) -> dict[str, Any] | None:
    models = [Contestant.from_dict(one) for one in contest["models"]]
    candidates = dict.fromkeys(e for one in models for e in one.effects)
    model = plant(config, list(candidates))
    own = {r: residual(root, config, model, r) for r in ("train", "validate", "heldout")}
    further: dict[str, list[Measurement]] = {}
    for trial, log in zip(contest["trials"], logs, strict=True):
        further.setdefault(trial["role"], []).append(Measurement.from_trace(read_log(log)))
    known = joined(own, further)
    settings = settings_of(config)
    search = decided_again(models, own, known, settings)
    before = read_json(root / SEARCH / "diagnosis.json", "diagnose")
    asked = {"experiment": contest["experiment"], "before": before["sentence"]}
    if search is None:
        aside = {**before, "next_experiment": "", "next_trials": []}
        write_json(root / OUT / "diagnosis.json", {**aside, "asked": {**asked, "aside": True}})
        tell(f"'{contest['experiment']}' shows what no contestant explains; the verdict stands")
        return None
    verdict = judge(search, own, settings)
    named, effort = verdict.kind == "named", own["train"].effort
    written = document(search, verdict, [], noise_floor(own["train"]), effort)
    kept = {key: before[key] for key in ("atlas", "atlas_sentences", "vague")}
    write_json(root / OUT / "diagnosis.json", {**written, **kept, "asked": asked})
    stands = model_of(search, verdict)
    write_json(root / OUT / "model.json", stands)
    changes = stands["changes"]
    overlay(root / OUT, own, search.rungs[0].fit.changes, changes)
    motion(root / OUT, own, changes)
    if named:
        laws(root / OUT, own, search, named)
    tell(f"after '{contest['experiment']}': {verdict.sentence}")
    return metrics(search, verdict, effort)


if __name__ == "__main__":
    run("decide", stage)
