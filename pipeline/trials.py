"""The trials of a configuration: the experiment's own, and the wraps for object size."""

from typing import Any

import numpy as np

from pipeline.schema import Config
from spirob.bench.wrap import wrap_trial

ROBOT_WRAPS, TRAIN_WRAPS, UNSEEN_WRAPS = 1, 2, 3  # streams of the seed


def experiment_trials(config: Config) -> list[dict[str, Any]]:
    """The trials that identification and diagnosis see."""
    return config.experiment.trials


def wraps(config: Config, stream: int) -> list[dict[str, Any]]:
    """Wrapping trials of one stream: each has its own draw of placement, speed and friction."""
    perceive = config.perceive
    prefix, sizes, repeats = {
        ROBOT_WRAPS: ("wrap", perceive.robot, perceive.robot_repeats),
        TRAIN_WRAPS: ("train", perceive.diameters, perceive.repeats),
        UNSEEN_WRAPS: ("unseen", perceive.unseen, perceive.unseen_repeats),
    }[stream]
    trials = []
    for i, diameter in enumerate(sizes):
        for k in range(repeats):
            rng = np.random.default_rng([perceive.seed, stream, i, k])
            name = f"{prefix}_{1e3 * diameter:04.1f}mm_{k}"
            trials.append(wrap_trial(name, "heldout", diameter, perceive.wrap, rng))
    return trials
