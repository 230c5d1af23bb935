"""Where a residual lies, as plain data: its regimes, orders, lateness, and what foretells it.

How much of a residual is lateness: of the measurement, or of the axis behind its command.

A measurement that trails the model by τ leaves, model minus measurement, i(t) - i(t - τ) ≈ τ di/dt;
so τ and its share of the squared error follow from a regression on the measured rate.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from spirob.diagnosis.atlas import atlas, situations, worst
from spirob.diagnosis.flexible import dependence, told
from spirob.diagnosis.spectrum import orders
from spirob.identify.problem import Stretch
from spirob.identify.residual import Residual


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


KEYS = ("atlas", "atlas_sentences", "atlas_orders", "atlas_lateness", "depends")


def survey(residual: Residual, changes: Mapping[str, float], values: np.ndarray) -> dict[str, Any]:
    """What the diagnosis says of the base model's residual; its keys are `KEYS`.

    changes  numbers of the base model;  values  what it leaves of the effort alone, (N,)
    """
    regimes = atlas(residual, values, situations(residual, changes))
    pieces = residual.stretches()
    waves = orders(pieces, values)
    alone = dependence(residual, values)
    return {
        "atlas": [r.as_dict() for r in regimes],
        "atlas_sentences": worst(regimes, residual.effort),
        "atlas_orders": [w.as_dict() for w in waves],
        "atlas_lateness": lateness(pieces, values),
        "depends": {"sentence": told(alone, waves), "alone": alone},
    }
