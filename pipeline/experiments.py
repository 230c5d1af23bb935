"""Stage `experiments`: the paper's experiments on the robot, in the model and in its baseline.

Writes every figure beside the paper's to data/experiments/experiments.json, with the curves for the
report, and those with an aim or a paper's figure to reports/metrics/experiments.json.
"""

from pathlib import Path
from typing import Any

from joblib import Parallel, delayed

from pipeline.schema import Config
from pipeline.sides import Models, informed, play_all
from pipeline.stage import (
    HIDDEN,
    entry,
    public_config,
    read_json,
    read_yaml,
    tell,
    workers,
    write_json,
)
from spirob.ending import end_with_parent
from spirob.experiments import Experiment, Play, Side, experiment_from
from spirob.plant import Rig

LOGS = Path("data/experiments/raw")
COLUMNS = ("robot", "base", "named", "single", "paper", "aim", "met")


def stage(root: Path) -> None:
    """Play and measure every experiment of the configuration."""
    config = public_config(root)
    hidden = read_yaml(root / HIDDEN, "config") or {}
    base = read_json(root / "data/identified/base.json", "identify")
    named = read_json(root / "data/diagnosis/model.json", "decide")
    models = {"base": {"effects": config.plant.effects, "changes": base["changes"]}, "named": named}
    written, metrics = {}, {}
    for name, settings in config.paper.items():
        experiment = experiment_from(name, settings, Rig.from_mapping(config.rig).geometry)
        experiment, known = informed(config, hidden, experiment, models, root / LOGS)
        sides = _played(root, config, hidden, known, experiment)
        rows = experiment.measure(sides)
        written[name] = {
            "title": experiment.title,
            "about": experiment.about,
            "rows": rows,
            "curves": experiment.curves(sides),
        }
        metrics[name] = {r["what"]: _figures(r) for r in rows if r["aim"] or r["paper"] is not None}
        aimed = [r["met"] for r in rows if isinstance(r["met"], bool)]
        tell(f"{name}: {sum(aimed)} of {len(aimed)} aims met")
    write_json(root / "data/experiments/experiments.json", written)
    write_json(root / "reports/metrics/experiments.json", metrics)


def _played(
    root: Path, config: Config, hidden: dict[str, Any], models: Models, experiment: Experiment
) -> dict[str, dict[str, Side]]:
    """Play -> side -> what it did, until the experiment wants no more."""
    plain = config.model_dump()
    run = Parallel(n_jobs=workers(), initializer=end_with_parent)
    sides: dict[str, dict[str, Side]] = {}
    plays = experiment.plays()
    while plays:
        answers = run([delayed(_one)(root, plain, hidden, play, models) for play in plays])
        for play, answer in zip(plays, answers, strict=True):
            sides[play.name] = _joined(sides.get(play.name, {}), answer)
        plays = experiment.more(sides)
    return sides


def _joined(before: dict[str, Side], answer: dict[str, Side]) -> dict[str, Side]:
    """With what was played before."""
    return before | {s: Side.mean([before[s], a]) if s in before else a for s, a in answer.items()}


def _one(
    root: Path, plain: dict[str, Any], hidden: dict[str, Any], play: Play, models: Models
) -> dict[str, Side]:
    log = root / LOGS / f"{play.name}.mcap"
    return play_all(Config.model_validate(plain), hidden, play, models, log)


def _figures(row: dict[str, Any]) -> dict[str, Any]:
    told = {k: row[k] for k in COLUMNS if row[k] is not None} | {"unit": row["unit"]}
    return told | ({"note": row["note"]} if row["note"] else {})


if __name__ == "__main__":
    entry("experiments", stage, __doc__)
