"""How much of a residual is lateness: of the measurement, or of the axis behind its command.

A measurement that trails the model by τ leaves, model minus measurement, i(t) - i(t - τ) ≈ τ di/dt;
so τ and its share of the squared error follow from a regression on the measured rate.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from spirob.identify.problem import Stretch


def lateness(pieces: Sequence[Stretch], values: np.ndarray) -> dict[str, Any]:
    """What a delay and what the command's rate explain of a residual (N,).

    delay_ms       by which the measurement trails the model [ms], negative where it is ahead
    delay_share    of the squared residual that this delay explains
    command_share  of it that follows the rate of the command; None where no command was recorded
    """
    slopes = np.concatenate([_slope(p.effort, p.seconds) for p in pieces])
    delay, share = _regressed(values, slopes)
    commands = [p.command_rate for p in pieces if p.command_rate is not None]
    known = len(commands) == len(pieces)
    return {
        "delay_ms": 1e3 * delay,
        "delay_share": share,
        "command_share": _regressed(values, np.concatenate(commands))[1] if known else None,
    }


def _slope(values: np.ndarray, seconds: np.ndarray) -> np.ndarray:
    return np.asarray(np.gradient(values, seconds)) if len(values) > 1 else np.zeros(len(values))


def _regressed(values: np.ndarray, on: np.ndarray) -> tuple[float, float]:
    """Slope of the regression without a constant, and the share of Σ values² that it explains."""
    power, both = float(on @ on), float(values @ on)
    if power == 0.0:
        return 0.0, 0.0
    return both / power, both**2 / (power * (float(values @ values) or 1.0))
