"""The trials of a configuration: those of `recordings`, and the wraps for object size."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from pipeline.schema import Config
from spirob.plant import Rig
from spirob.trials.trial import WrapSettings, wrap_trial

# Streams of the seed.  1, 3, 4 and 6 to 8 are used up: the errors on wraps drawn from them were
# known when what the stack learns from was fixed, so that they cannot test it any more.
# 9 draws the machines (`wraps.py`).
PAPER_WRAPS, TRAIN_DRAWN = 2, 5
ROBOT_WRAPS, UNSEEN_WRAPS, UNSEEN_DRAWN = 10, 11, 12


def recorded_trials(config: Config) -> list[dict[str, Any]]:
    """The trials that identification and diagnosis see."""
    return config.recordings.trials


def robot_wraps(config: Config) -> list[dict[str, Any]]:
    """Wraps that the robot does."""
    perceive = config.perceive
    return _listed(config, "wrap", ROBOT_WRAPS, perceive.robot, perceive.robot_repeats)


def paper_wraps(config: Config) -> list[dict[str, Any]]:
    """Training wraps of the listed diameters; by default the paper's 35 samples."""
    perceive = config.perceive
    return _listed(config, "train", PAPER_WRAPS, perceive.diameters, perceive.repeats)


def train_wraps(config: Config) -> list[dict[str, Any]]:
    """What the shipped predictor learns from: the listed ones, then those of drawn diameters."""
    drawn = config.perceive.drawn
    settings = config.perceive.wrap | drawn.wrap
    return paper_wraps(config) + _drawn(config, "drawn", TRAIN_DRAWN, drawn.count, settings)


def compared_wraps(config: Config) -> list[dict[str, Any]]:
    """The first of them, which every model plays whose worth for sizes is compared."""
    drawn = config.perceive.drawn
    return train_wraps(config)[: len(paper_wraps(config)) + min(drawn.count, drawn.compared)]


def unseen_wraps(config: Config) -> list[dict[str, Any]]:
    """Wraps of diameters that no training sees: the listed ones, then drawn ones."""
    perceive = config.perceive
    listed = _listed(config, "unseen", UNSEEN_WRAPS, perceive.unseen, perceive.unseen_repeats)
    drawn = _drawn(config, "between", UNSEEN_DRAWN, perceive.unseen_drawn, perceive.wrap)
    return listed + drawn


def _listed(
    config: Config, prefix: str, stream: int, sizes: Sequence[float], repeats: int
) -> list[dict[str, Any]]:
    """So many wraps of each diameter; each has its own draw of placement, speed and friction."""
    perceive, geometry = config.perceive, Rig.from_mapping(config.rig).geometry
    trials = []
    for i, diameter in enumerate(sizes):
        for k in range(repeats):
            rng = np.random.default_rng([perceive.seed, stream, i, k])
            name = f"{prefix}_{1e3 * diameter:04.1f}mm_{k}"
            trials.append(wrap_trial(name, "heldout", diameter, perceive.wrap, rng, geometry))
    return trials


def _drawn(
    config: Config, prefix: str, stream: int, count: int, given: dict[str, Any]
) -> list[dict[str, Any]]:
    """Wraps of diameters drawn evenly between the smallest and the largest listed one.

    The n-th wrap depends on no other: a larger set begins with the smaller one.
    """
    sizes, settings = config.perceive.diameters, WrapSettings.from_mapping(given)
    geometry = Rig.from_mapping(config.rig).geometry
    trials = []
    for k in range(count):
        rng = np.random.default_rng([config.perceive.seed, stream, k])
        diameter = float(rng.uniform(min(sizes), max(sizes)))
        trials.append(wrap_trial(f"{prefix}_{k:05d}", "heldout", diameter, settings, rng, geometry))
    return trials
