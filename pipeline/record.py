"""Record the configured trials on hardware into data/recorded/logs (no stage of `dvc repro`)."""

import shutil
from pathlib import Path

from pipeline.collect import RECORDED
from pipeline.robots import record_all
from pipeline.stage import entry, public_config, tell
from pipeline.trials import recorded_trials, robot_wraps
from spirob.errors import ConfigError


def stage(root: Path) -> None:
    """Play every trial on the robot of the configuration, which must be `can`.

    A log cannot be made again: each is put away when its trial has ended, one that is there is
    kept, and that of a stopped trial lies beside the folder.
    """
    config = public_config(root)
    if config.robot.kind != "can":
        raise ConfigError("recording is for hardware: set overrides: ['robot=can'] in params.yaml")
    (root / RECORDED).mkdir(parents=True, exist_ok=True)
    for trial in recorded_trials(config) + robot_wraps(config):
        kept = root / RECORDED / f"{trial['name']}.mcap"
        if kept.exists():
            tell(f"{kept.name} is recorded and kept; remove it to play its trial again")
            continue
        log = root / "data/raw" / kept.name
        part = log.with_name(f"{log.name}.part")
        try:
            record_all(root, config, {}, [trial])
            shutil.move(log, kept)
        finally:
            if part.exists():  # data/raw is emptied by the next `dvc repro`
                shutil.move(part, kept.parent.parent / part.name)


if __name__ == "__main__":
    entry("record", stage, __doc__)
