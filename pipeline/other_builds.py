"""Object size on other builds: the shipped predictor, on robots that nobody measured.

Each is the emulated robot built anew: with its data sheet, with what it hides, and with a build of
its own.  It wraps the objects that the robot wraps, and nothing is trained, fitted or named again.

    python -m pipeline.other_builds

It looks into the robot, so it is no stage and nothing reads what it writes,
reports/metrics/other_builds.json.  It takes a minute or two for each build.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.robots import record_all
from pipeline.schema import Config
from pipeline.stage import HIDDEN, entry, public_config, read_yaml, rounded, tell, write_json
from pipeline.trials import robot_wraps
from spirob.errors import ConfigError
from spirob.logs import read_log
from spirob.perceive.features import table
from spirob.perceive.interval import CONFIDENCE, coverage, estimate, supported
from spirob.perceive.model_file import load_model
from spirob.perceive.size import SizeModel, predict
from spirob.perceive.study import MILLIMETRES, scored

BUILDS = 5
LOGS = Path("data/other_builds")


def stage(root: Path) -> None:
    """Build robots anew, have them wrap, and tell the sizes."""
    config = public_config(root)
    if config.robot.kind != "emulated":
        raise ConfigError("only an emulated robot can be built anew")
    shipped = load_model(root / "data/models/size.skops")
    hidden = read_yaml(root / HIDDEN, "config") or {}
    found: dict[str, Any] = {}
    for seed in seeds(BUILDS, int(hidden["seed"])):
        found[f"build_{seed}"] = told = _told(root, config, {**hidden, "built": seed}, shipped)
        tell(f"build {seed}: {told['mae']:.2f} mm, R² {told['r2']:.3f}")
    errors = [told["mae"] for told in found.values()]
    whole = rounded({"median": float(np.median(errors)), "most": max(errors)})
    metrics = {"builds": found, "mae": {**whole, "unit": "mm"}}
    write_json(root / "reports/metrics/other_builds.json", metrics)


def seeds(count: int, own: int) -> list[int]:
    """So many seeds that builds are drawn by, none of them the robot's own."""
    return [seed for seed in range(1, count + 2) if seed != own][:count]


def _told(
    root: Path, config: Config, hidden: Mapping[str, Any], shipped: SizeModel
) -> dict[str, Any]:
    """How well sizes are told on one build, and how often their intervals hold."""
    # of a held-out trial the shape is kept beside the truth, where the robot's own lies
    trials = [{**trial, "role": "validate"} for trial in robot_wraps(config)]
    folder = LOGS / str(hidden["built"])
    record_all(root, config, hidden, trials, folder)
    features = table([read_log(root / folder / f"{trial['name']}.mcap") for trial in trials])
    true, sizes = features["diameter"].to_numpy(), predict(shipped, features)
    errors = scored(true, sizes, config.perceive.seed)
    told: dict[str, Any] = rounded({**errors, "bias": MILLIMETRES * float(np.mean(sizes - true))})
    if supported(shipped):
        held = coverage(estimate(shipped, features), true)
        told["interval"] = {"confidence": CONFIDENCE, **rounded(held)}
    return told


if __name__ == "__main__":
    entry("other_builds", stage, __doc__)
