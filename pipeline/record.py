"""Record the configured trials on hardware into data/recorded/logs (no stage of `dvc repro`)."""

import shutil
from pathlib import Path

from pipeline.collect import RECORDED
from pipeline.robots import record_all
from pipeline.stage import public_config, run
from pipeline.trials import experiment_trials, robot_wraps
from spirob.errors import ConfigError


def stage(root: Path) -> None:
    """Play every trial on the robot of the configuration, which must be `can`."""
    config = public_config(root)
    if config.robot.kind != "can":
        raise ConfigError("recording is for hardware: set overrides: ['robot=can'] in params.yaml")
    trials = experiment_trials(config) + robot_wraps(config)
    record_all(root, config, {}, trials)
    for trial in trials:
        name = f"{trial['name']}.mcap"
        (root / RECORDED).mkdir(parents=True, exist_ok=True)
        shutil.move(root / "data/raw" / name, root / RECORDED / name)


if __name__ == "__main__":
    run("record", stage)
