"""The noise floor: what no model could explain."""

import numpy as np

from spirob.identify.residual import Residual


def noise_floor(residual: Residual) -> float:
    """RMS of the sensor noise that passes the residual's filter [A].

    White noise of a sensor is taken from second differences of the raw current, in which the slow
    signal all but vanishes (std of x_k - 2x_(k+1) + x_(k+2) is √6 σ; the median absolute deviation
    ignores the fast events); the filter lets through the share that it does of white noise.
    """
    white = np.random.default_rng(0).standard_normal(20_000)
    passed = float(np.std(residual.filter(white)))
    levels = []
    for trial in residual.trials:
        for motor in residual.driven(trial):
            second = np.diff(trial.current[:, motor], n=2)
            spread = 1.4826 * float(np.median(np.abs(second - np.median(second))))
            levels.append(spread / np.sqrt(6))
    return float(np.sqrt(np.mean(np.square(levels)))) * passed
