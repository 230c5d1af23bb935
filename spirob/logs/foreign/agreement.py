"""Units that cannot be right: what the column itself says, and what two channels say together."""

import re

import numpy as np

from spirob.errors import DataError
from spirob.logs.foreign.mapping import Mapping
from spirob.units import UNITS

_BRACKETED = re.compile(r"[\[(]\s*([^\[\]()\d][^\[\]()]{0,11}?)\s*[\])]\s*$")
_RATES = {"displacement": "velocity"}
ALIKE = 0.9  # correlation above which two channels are one motion
FAR = 1.5  # times by which a rate may differ from its channel's own


def check_names(where: str, mapping: Mapping) -> None:
    """A column named 'I [mA]' is not in A; raises DataError."""
    named = {channel: (c.column, c.unit) for channel, c in mapping.channels.items()}
    named["time"] = mapping.time.column, mapping.time.unit
    for channel, (column, given) in named.items():
        found = _BRACKETED.search(column)
        if found and found[1] in UNITS and UNITS[found[1]] != UNITS[given]:
            raise DataError(
                f"{where}: column '{column}' says {found[1]}, the mapping of {channel} says {given}"
            )


def check_rates(where: str, time_ns: np.ndarray, signals: dict[str, np.ndarray]) -> None:
    """A velocity must be the rate of its displacement; raises DataError with the factor."""
    for channel, values in signals.items():
        motor, _, kind = channel.rpartition(".")
        other = f"{motor}.{_RATES.get(kind, '')}"
        if other not in signals or len(values) < 10:
            continue
        rate = np.gradient(values, time_ns * 1e-9)
        told = signals[other]
        good = np.isfinite(rate) & np.isfinite(told)
        rate, told = _smooth(rate[good]), _smooth(told[good])
        if len(rate) < 10 or rate.std() == 0 or told.std() == 0:
            continue
        alike = float(np.corrcoef(rate, told)[0, 1])
        factor = float(np.dot(rate, told) / np.dot(rate, rate))
        if abs(alike) > ALIKE and not 1 / FAR < factor < FAR:
            raise DataError(
                f"{where}: {other} is {factor:.4g} times the rate of {channel}; check unit and sign"
            )


def _smooth(values: np.ndarray) -> np.ndarray:
    width = max(1, len(values) // 200)
    return np.convolve(values, np.ones(width) / width, "valid")
