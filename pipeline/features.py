"""Stage `features`: wrap cylinders in the diagnosed model, and turn all wraps into features."""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pandas as pd

from pipeline.model import plant
from pipeline.schema import Config
from pipeline.stage import public_config, read_json, run, tell, workers
from pipeline.trials import ROBOT_WRAPS, TRAIN_WRAPS, UNSEEN_WRAPS, wraps
from spirob.bench import Trial
from spirob.bench.simulate import simulate
from spirob.effects import find_effects
from spirob.errors import MissingLog
from spirob.logs import read_parquet
from spirob.logs.atomic import replacing
from spirob.perceive.features import table
from spirob.trace import Trace

SENSOR_NOISE = 0.005  # A, of a drive of this class; the robot's own is not known


def stage(root: Path) -> None:
    """Features of simulated training wraps, simulated unseen sizes, and the robot's wraps."""
    config = public_config(root)
    model = read_json(root / "data/diagnosis/model.json", "diagnose")
    for name, stream in (("train", TRAIN_WRAPS), ("unseen", UNSEEN_WRAPS)):
        traces = simulated(config, model, wraps(config, stream))
        _write(root / f"data/features/{name}.parquet", table(traces))
        tell(f"{name}: {len(traces)} simulated wraps")
    recorded = [_recorded(root, t["name"]) for t in wraps(config, ROBOT_WRAPS)]
    _write(root / "data/features/robot.parquet", table(recorded))
    tell(f"robot: {len(recorded)} wraps")


def simulated(
    config: Config, model: Mapping[str, Any], trials: Sequence[dict[str, Any]]
) -> list[Trace]:
    """Wraps played in a model `{effects: [...], changes: {...}}`, with sensor noise."""
    machine = plant(config, find_effects(model["effects"]))
    known = set(machine.table.names)
    changes = {k: v for k, v in model["changes"].items() if k in known}

    def one(job: tuple[int, dict[str, Any]]) -> Trace:
        number, plain = job
        trial = Trial.from_plain(plain)
        return simulate(machine, trial, changes, SENSOR_NOISE, config.perceive.seed + number)

    with ThreadPoolExecutor(workers()) as pool:
        return list(pool.map(one, enumerate(trials)))


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
