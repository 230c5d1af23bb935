"""Hydra multirun over any configuration key, in parallel, into one table.

    python -m pipeline.sweep -m robot.hidden.strength=0,1 identify.filter.cutoff=20,40

Each point collects, decodes, identifies and compares in a folder of its own, named by a hash of
its configuration; a point that is already there is not run again.  `dvc repro` then shows the
table data/sweep/table.json in the report.  The launcher runs as many points at once as there are
cores; another launcher (SLURM, Dask) is a choice of the command line, `hydra/launcher=...`.
"""

import hashlib
import json
import sys
from multiprocessing import parent_process
from pathlib import Path
from typing import Any

import hydra
from hydra.core.hydra_config import HydraConfig
from omegaconf import DictConfig, OmegaConf

from pipeline import collect, compare, config, decode, identify
from pipeline.stage import FAILED, read_json, tell, write_json
from spirob.ending import end_with_parent
from spirob.errors import SpirobError

TABLE = Path("data/sweep/table.json")
POINTS = Path("data/sweep/points")


@hydra.main(version_base="1.3", config_path="../conf", config_name="config")
def main(composed: DictConfig) -> None:
    """Run one point of the grid."""
    if parent_process():  # a worker of the launcher
        end_with_parent()
    overrides = [str(o) for o in HydraConfig.get().overrides.task]
    try:
        plain = OmegaConf.to_container(composed, resolve=True)
        point(Path("."), plain, overrides)
    except SpirobError as error:
        print(f"sweep: {', '.join(overrides)}: {error}", file=sys.stderr)
        sys.exit(FAILED)


def point(root: Path, plain: Any, overrides: list[str]) -> None:
    """Run a point unless its result exists, then write the table of all points anew."""
    text = json.dumps(plain, sort_keys=True)
    folder = root / POINTS / hashlib.sha256(text.encode()).hexdigest()[:16]
    result = folder / "point.json"
    if not result.exists():
        config.write(folder, plain, "conf/ with overrides " + ", ".join(overrides))
        collect.stage(folder, with_wraps=False)
        for stage in (decode, identify, compare):
            stage.stage(folder)
        scores = read_json(folder / "reports/metrics/compare.json", "compare")
        fitted = read_json(folder / "reports/metrics/identify.json", "identify")
        write_json(result, {"overrides": overrides, "compare": scores, "train": fitted["train"]})
    write_table(root)
    tell(f"{', '.join(overrides) or 'default'}: done")


def write_table(root: Path) -> None:
    """data/sweep/table.json: one row a point, sorted by what was overridden."""
    points = [json.loads(p.read_text()) for p in (root / POINTS).glob("*/point.json")]
    points.sort(key=lambda p: p["overrides"])
    keys = sorted({o.split("=", 1)[0] for p in points for o in p["overrides"]})
    figures = [
        "train current RMSE [A]",
        "held-out current RMSE [A]",
        "held-out current R²",
        "held-out velocity RMSE [m/s]",
    ]
    rows = []
    for entry in points:
        chosen = dict(o.split("=", 1) for o in entry["overrides"])
        scores = entry["compare"]
        current, velocity = scores["current"], scores["velocity"]
        rows.append(
            [chosen.get(k, "") for k in keys]
            + [entry["train"]["rmse"], current["rmse"], current["r2"], velocity["rmse"]]
        )
    write_json(root / TABLE, {"columns": [*keys, *figures], "rows": rows})


if __name__ == "__main__":
    main()
