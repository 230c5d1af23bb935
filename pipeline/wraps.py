"""Stage `wraps`: the wraps that size is learned from, played in the diagnosed model by multirun.

    python -m pipeline.wraps -m "part=range(8)"

Each job of the Hydra multirun plays one share and writes its features to data/wraps; stage
`features` puts them together.  How many shares there are changes no bit of them.  The launcher runs
as many jobs at once as there are cores; another launcher (SLURM, Dask) is a choice of the command
line, `hydra/launcher=...`.

No two of the machines that play the drawn ones are built alike or have the same numbers.  A model
is never quite the robot.  What is learned from one model alone leans on whatever tells its sizes
best, on features too that the robot has otherwise; learned from many builds about the model it has
to do with what they have in common (domain randomisation: Tobin et al., IROS 2017).
"""

import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import parent_process
from pathlib import Path
from typing import Any

import hydra
import numpy as np
import pandas as pd
from omegaconf import DictConfig

from pipeline.model import plant
from pipeline.schema import Config
from pipeline.stage import FAILED, public_config, read_json, tell, workers
from pipeline.trials import paper_wraps, train_wraps
from spirob.effects import find_effects
from spirob.ending import end_with_parent
from spirob.errors import ConfigError, MissingLog, SpirobError
from spirob.files import replacing
from spirob.identify.builds import anew
from spirob.perceive.features import table
from spirob.plant import Plant
from spirob.trials import Trial
from spirob.trials.simulation import simulate

SENSOR_NOISE = 0.005  # A, of a drive of this class; the robot's own is not known
SHARES = Path("data/wraps")


@hydra.main(version_base="1.3", config_path="../conf", config_name="wraps")
def main(shared: DictConfig) -> None:
    """Play one share."""
    if parent_process():  # a worker of the launcher
        end_with_parent()
    try:
        share(Path("."), shared.part, shared.parts)
    except SpirobError as error:
        print(f"wraps: {error}", file=sys.stderr)
        sys.exit(FAILED)


def share(root: Path, part: int, parts: int) -> None:
    """Play the share `part` of `parts`, neighbours in the order of the training wraps.

    Raises ConfigError where there is no such share.
    """
    if not 0 <= part < parts:
        raise ConfigError(f"share {part} of {parts}: shares are counted from 0 to {parts - 1}")
    config = public_config(root)
    model = read_json(root / "data/diagnosis/model.json", "decide")
    trials = train_wraps(config)
    mine = np.array_split(np.arange(len(trials)), parts)[part]
    if len(mine):
        chosen = [trials[k] for k in mine]
        features = wrapped(config, model, chosen, int(mine[0]), threads=1, training=True)
        write(root / SHARES / f"{part:03d}_of_{parts:03d}.parquet", features)
        tell(f"wraps {mine[0] + 1} to {mine[-1] + 1} of {len(trials)}")


def together(root: Path, config: Config) -> pd.DataFrame:
    """Features of all training wraps in their order, of the shares that were played.

    Raises MissingLog where they are not all there, or not of this configuration.
    """
    shares = [pd.read_parquet(path) for path in sorted((root / SHARES).glob("*_of_*.parquet"))]
    wanted = [trial["name"] for trial in train_wraps(config)]
    played = [name for features in shares for name in features.index]
    if played != wanted:
        raise MissingLog(
            f"{SHARES} holds {len(played)} wraps where the configuration asks for {len(wanted)}, "
            "or others; empty it, and the stage 'wraps' writes it"
        )
    return pd.concat(shares)


def wrapped(
    config: Config,
    model: Mapping[str, Any],
    trials: Sequence[dict[str, Any]],
    first: int = 0,
    threads: int | None = None,
    training: bool = False,
) -> pd.DataFrame:
    """Features of wraps in a model `{effects: [...], changes: {...}}`, with sensor noise.

    first     number of the first wrap, which its noise is drawn by;  threads  all cores by default
    training  of training wraps those of drawn diameters are each played by a build of its own
    Each wrap is given up as soon as its features are known: a thousand of them need no gigabyte.
    """
    machine = plant(config, find_effects(model["effects"]))
    known = set(machine.table.names)
    changes = {k: v for k, v in model["changes"].items() if k in known}
    listed = len(paper_wraps(config))

    def one(job: tuple[int, dict[str, Any]]) -> pd.DataFrame:
        number, plain = job
        trial = Trial.from_plain(plain)
        seed = config.perceive.seed + number
        played, numbers = machine, changes
        if training and number >= listed:
            played, numbers = build_of(config, machine, changes, number - listed)
        return table([simulate(played, trial, numbers, SENSOR_NOISE, seed)])

    with ThreadPoolExecutor(threads or workers()) as pool:
        return pd.concat(list(pool.map(one, enumerate(trials, first))))


def write(path: Path, features: pd.DataFrame) -> None:
    """A table of features, whole or not at all."""
    with replacing(path) as temporary:
        features.to_parquet(temporary, compression="zstd")


MACHINES = 9  # stream of the seed


def build_of(
    config: Config, model: Plant, changes: Mapping[str, float], k: int
) -> tuple[Plant, dict[str, float]]:
    """The machine that plays the k-th drawn wrap, and its numbers.

    It is a build of the model's arm: its hinges and holes scatter, and what a fit leaves open of a
    build differs (`identify.builds`).  What is fitted, and what the model's effects bring, is
    multiplied by a factor of its own besides, drawn evenly from 1 ± `perceive.drawn.machines`, and
    kept within its bounds; all else is as in `changes`.  Where that is 0, it is the model itself.
    The k-th machine depends on no other.
    """
    spread, table = config.perceive.drawn.machines, model.table
    if spread == 0.0:
        return model, dict(changes)
    brought = [f"{e.name()}.{f}" for e in model.effects for f in e.parameters()]
    names = [*config.identify.parameters, *brought]
    rng = np.random.default_rng([config.perceive.seed, MACHINES, k])
    factors = 1.0 + spread * rng.uniform(-1.0, 1.0, len(names))
    values = table.vector(changes)[[table.position(name) for name in names]]
    moved = np.clip(values * factors, *table.bounds(names))
    numbers = {**changes, **dict(zip(names, moved.tolist(), strict=True))}
    return anew(model, numbers, rng)


if __name__ == "__main__":
    main()
