"""Noise of a sensor is told alike at any rate of a log that the model plays at its own."""

import numpy as np
import pytest

from spirob.diagnosis.criteria import noise_floor
from spirob.identify.residual import Filter

SIGMA = 6e-3  # A


class Trials:
    """A slow current with noise as a logger of one rate has it, put on the model's clock."""

    def __init__(self, every):
        self.every, self.filter = every, Filter(cutoff=25.0, every=5)
        t = np.arange(0, 20_000, every)
        noise = np.random.default_rng(every).normal(0.0, SIGMA, len(t))
        logged = 0.3 + 0.2 * np.sin(2 * np.pi * 0.4 * 1e-3 * t) + noise
        clock = np.arange(t[-1])
        self.noise, self.current = np.interp(clock, t, noise), np.interp(clock, t, logged)

    def raw(self):
        return [self.current[:: self.every]]

    def spaced(self):
        return [self.every]


@pytest.mark.parametrize("every", [1, 2, 4, 5, 10])
def test_the_noise_that_passes_is_told_at_any_rate(every):
    trials = Trials(every)
    passed = np.std(trials.filter(trials.noise))
    assert noise_floor(trials) == pytest.approx(passed, rel=0.1)
