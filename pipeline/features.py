"""Stage `features`: all wraps as features: of the model, of unseen sizes, of the robot."""

from pathlib import Path

import pandas as pd

from pipeline.stage import entry, public_config, read_json, tell, trace_of, written
from pipeline.trials import paper_wraps, robot_wraps, unseen_wraps
from pipeline.wraps import together, wrapped, write
from spirob.perceive.features import table

FOLDER = Path("data/features")


def stage(root: Path) -> None:
    """Features of simulated training wraps, simulated unseen sizes, and the robot's wraps.

    train.parquet begins with the listed diameters (the paper's samples), which paper.parquet holds
    alone.
    """
    config = public_config(root)
    model = read_json(root / "data/diagnosis/model.json", "decide")
    train = together(root, config)
    unseen = wrapped(config, model, unseen_wraps(config))
    for name, features in (("train", train), ("unseen", unseen)):
        write(root / FOLDER / f"{name}.parquet", features)
        tell(f"{name}: {len(features)} simulated wraps")
    write(root / FOLDER / "paper.parquet", train[: len(paper_wraps(config))])
    recorded = [trace_of(root, t["name"]) for t in robot_wraps(config)]
    write(root / FOLDER / "robot.parquet", table(recorded))
    tell(f"robot: {len(recorded)} wraps")


def features_of(root: Path, name: str) -> pd.DataFrame:
    """A table that this stage wrote; MissingLog where it did not."""
    return pd.read_parquet(written(root / FOLDER / f"{name}.parquet", "features"))


if __name__ == "__main__":
    entry("features", stage, __doc__)
