"""Wraps simulated with the plant, as traces and as a table of features."""

import numpy as np
import pytest

from spirob.logs.trace import Trace
from spirob.perceive.features import table
from spirob.plant import Plant, Rig
from spirob.trials import Trial
from spirob.trials.trial import wrap_trial

SIZES = (0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07)
DAMPING = {"motor.rotor_damping": 5e-5}
LSB = 20 / 16384  # A


def simulate(plant, plain, changes=None):
    """The left motor's signals of a trial, with the current in whole counts."""
    trial = Trial.from_plain(plain)
    response = plant.simulate(trial.schedule(), trial.scene, changes or DAMPING)
    signals = {
        "left.current": np.rint(response.current[:, 0] / LSB) * LSB,
        "left.displacement": response.displacement[:, 0],
        "left.velocity": response.velocity[:, 0],
    }
    units = {"left.current": "A", "left.displacement": "m", "left.velocity": "m/s"}
    stamps = np.arange(trial.cycles, dtype=np.int64) * 1_000_000
    return Trace(trial.name, stamps, signals, units, {"scene": plain["scene"]})


def changed(trace, **signals):
    """The same trace with some of the left motor's signals replaced."""
    replaced = {f"left.{name}": values for name, values in signals.items()}
    stamps = np.arange(len(next(iter(replaced.values()))), dtype=np.int64) * 1_000_000
    return Trace(trace.name, stamps, {**trace.signals, **replaced}, trace.units, trace.meta)


@pytest.fixture(scope="session")
def plant():
    return Plant(Rig())


@pytest.fixture(scope="session")
def wraps(plant):
    rng = np.random.default_rng(0)
    names = [(size, k) for size in SIZES for k in range(3)]
    plain = [wrap_trial(f"wrap_{1e3 * s:.0f}_{k}", "train", s, {}, rng) for s, k in names]
    return [simulate(plant, given) for given in plain]


@pytest.fixture(scope="session")
def known(wraps):
    return table(wraps)
