"""Stage `collect`: play all trials on the robot; one MCAP log each, and the truth apart.

Real hardware is never driven from here: its logs are recorded with `python -m pipeline.record`
and lie in data/recorded/logs.
"""

import shutil
from pathlib import Path

from pipeline.robots import POSTURE, record_all
from pipeline.stage import HIDDEN, entry, public_config, read_yaml, write_json
from pipeline.trials import recorded_trials, robot_wraps
from spirob.errors import MissingLog
from spirob.files import replacing

RECORDED = Path("data/recorded/logs")


def stage(root: Path, with_wraps: bool = True) -> None:
    """Record the experiment and, for object size, the wraps."""
    config = public_config(root)
    trials = recorded_trials(config) + (robot_wraps(config) if with_wraps else [])
    truth = {}
    (root / POSTURE).mkdir(parents=True, exist_ok=True)  # stays empty where nothing can be seen
    if config.robot.kind == "can":
        for trial in trials:
            _fetch(root, f"{trial['name']}.mcap")
    else:
        hidden = read_yaml(root / HIDDEN, "config") or {}
        truth = record_all(root, config, hidden, trials)
    write_json(root / "data/truth/truth.json", truth)


def _fetch(root: Path, name: str) -> None:
    source = root / RECORDED / name
    if not source.exists():
        raise MissingLog(
            f"{source} is missing; record it with `python -m pipeline.record`, or get it with "
            "`dvc pull`"
        )
    with replacing(root / "data/raw" / name) as temporary:
        shutil.copyfile(source, temporary)


if __name__ == "__main__":
    entry("collect", stage, __doc__)
