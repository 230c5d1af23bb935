"""A residual that is linear in the logarithms of its numbers, with autocorrelated noise."""

import numpy as np
from scipy.signal import butter, sosfiltfilt

from spirob.identify.problem import Effort
from spirob.parameter import Parameter, Table

LOW_PASS = butter(2, 30.0, fs=1000.0, output="sos")
TRIALS, SAMPLES = 2, 400  # at 100 Hz


def filtered_noise(random, size):
    """What a 30 Hz filter leaves of white noise, every tenth sample, deviation `size`."""
    white = random.standard_normal(10 * TRIALS * SAMPLES)
    kept = sosfiltfilt(LOW_PASS, white)[::10]
    return size * kept / kept.std()


class Linear:
    """residual = slopes @ ln(p/true) + noise; a column of slopes may be weak."""

    edges = np.arange(TRIALS + 1) * SAMPLES
    rows = np.ones(TRIALS * SAMPLES, dtype=bool)
    block = 50
    effort = Effort("motor current", "A")

    def __init__(self, strengths, true, noise, seed=0):
        shapes = np.random.default_rng(7).standard_normal((len(strengths), 12))
        time = np.linspace(0.0, 1.0, TRIALS * SAMPLES)
        waves = np.array([np.sin(2 * np.pi * k * time + k) for k in range(1, 13)])
        self.slopes = (np.array(strengths)[:, None] * shapes @ waves).T
        self.names = [f"part.n{k}" for k in range(len(strengths))]
        about = Parameter(1.0, 0.01, 100.0, "1", "n", "a number", log=True)
        self.table = Table.of(dict.fromkeys(self.names, about), {})
        self.true = np.array(true)
        self.noise = filtered_noise(np.random.default_rng(seed), noise)

    def measured(self):
        return np.ones(TRIALS * SAMPLES)

    def __call__(self, changes):
        u = np.log([changes.get(name, 1.0) for name in self.names])
        return self.slopes @ (u - np.log(self.true)) + self.noise

    def many(self, points):
        return [self(point) for point in points]
