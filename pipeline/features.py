"""Stage `features`: wrap cylinders in the diagnosed model, and turn all wraps into features."""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pandas as pd

from pipeline.model import plant
from pipeline.schema import Config
from pipeline.stage import public_config, read_json, run, tell, workers
from pipeline.trials import paper_wraps, robot_wraps, train_wraps, unseen_wraps
from spirob.bench import Trial
from spirob.bench.simulate import simulate
from spirob.effects import find_effects
from spirob.errors import MissingLog
from spirob.logs import read_parquet
from spirob.logs.atomic import replacing
from spirob.perceive.features import table
from spirob.trace import Trace

SENSOR_NOISE = 0.005  # A, of a drive of this class; the robot's own is not known
FOLDER = Path("data/features")


def stage(root: Path) -> None:
    """Features of simulated training wraps, simulated unseen sizes, and the robot's wraps.

    train.parquet begins with the listed diameters (the paper's samples), which paper.parquet holds
    alone.
    """
    config = public_config(root)
    model = read_json(root / "data/diagnosis/model.json", "decide")
    for name, trials in (("train", train_wraps(config)), ("unseen", unseen_wraps(config))):
        features = wrapped(config, model, trials)
        _write(root / FOLDER / f"{name}.parquet", features)
        if name == "train":
            _write(root / FOLDER / "paper.parquet", features[: len(paper_wraps(config))])
        tell(f"{name}: {len(features)} simulated wraps")
    recorded = [_recorded(root, t["name"]) for t in robot_wraps(config)]
    _write(root / FOLDER / "robot.parquet", table(recorded))
    tell(f"robot: {len(recorded)} wraps")


def wrapped(
    config: Config, model: Mapping[str, Any], trials: Sequence[dict[str, Any]]
) -> pd.DataFrame:
    """Features of wraps in a model `{effects: [...], changes: {...}}`, with sensor noise.

    Each wrap is given up as soon as its features are known: a thousand of them need no gigabyte.
    """
    machine = plant(config, find_effects(model["effects"]))
    known = set(machine.table.names)
    changes = {k: v for k, v in model["changes"].items() if k in known}

    def one(job: tuple[int, dict[str, Any]]) -> pd.DataFrame:
        number, plain = job
        trial = Trial.from_plain(plain)
        seed = config.perceive.seed + number
        return table([simulate(machine, trial, changes, SENSOR_NOISE, seed)])

    with ThreadPoolExecutor(workers()) as pool:
        return pd.concat(list(pool.map(one, enumerate(trials))))


def features_of(root: Path, name: str) -> pd.DataFrame:
    """A table that this stage wrote; MissingLog where it did not."""
    path = root / FOLDER / f"{name}.parquet"
    if not path.exists():
        raise MissingLog(f"{path} is missing; the stage 'features' writes it")
    return pd.read_parquet(path)


def _recorded(root: Path, name: str) -> Trace:
    path = root / "data/traces" / f"{name}.parquet"
    if not path.exists():
        raise MissingLog(f"{path} is missing; the stage 'decode' writes it")
    return read_parquet(path)


def _write(path: Path, features: pd.DataFrame) -> None:
    with replacing(path) as temporary:
        features.to_parquet(temporary, compression="zstd")


if __name__ == "__main__":
    run("features", stage)
