"""Logs of the model itself, so that the true numbers are known, with noise on its sensors."""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from spirob.bench import Trial, record
from spirob.bench.simulated import SimulatedRobot
from spirob.can_protocol import AMPERE_PER_COUNT
from spirob.identify.measurement import Measurement
from spirob.logs import Transmission, read_log
from spirob.plant import Plant


def logged(plant: Plant, trials: Sequence[Trial], true: Mapping[str, float]) -> list[Measurement]:
    """Trials played by the model with the numbers `true` over its bus, recorded and decoded."""
    rig = plant.rig
    robot = SimulatedRobot(plant, true)
    found = []
    with tempfile.TemporaryDirectory(prefix="spirob-logged-") as folder:
        for trial in trials:
            path = record(
                trial,
                robot,
                Path(folder) / f"{trial.name}.mcap",
                transmission=Transmission(
                    gear_ratio=rig.winch.gear_ratio, winch_radius=rig.winch.radius
                ),
                gains=rig.gains,
                rig=rig.name,
            )
            found.append(Measurement.from_trace(read_log(path)))
    return found


def noisy(trial: Measurement, noise: float, random: np.random.Generator) -> Measurement:
    """The same with white noise of this deviation [A] on both current sensors, in whole counts.

    No controller hears it: they feed back displacement and velocity.
    """
    counts = np.round(random.normal(0.0, noise / AMPERE_PER_COUNT, trial.current.shape))
    return replace(trial, current=trial.current + counts * AMPERE_PER_COUNT)
