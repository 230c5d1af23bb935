"""Units of a file to SI: value_SI = factor · (value + offset); which numbers a machine may have."""

from dataclasses import dataclass
from math import pi
from typing import Annotated

from pydantic import AfterValidator

from spirob.errors import ConfigError


@dataclass(frozen=True)
class Unit:
    """What a unit is in SI."""

    si: str
    factor: float = 1.0
    offset: float = 0.0


_INCH = 0.0254
UNITS = {
    "s": Unit("s"),
    "ms": Unit("s", 1e-3),
    "us": Unit("s", 1e-6),
    "µs": Unit("s", 1e-6),
    "ns": Unit("s", 1e-9),
    "min": Unit("s", 60.0),
    "A": Unit("A"),
    "mA": Unit("A", 1e-3),
    "V": Unit("V"),
    "mV": Unit("V", 1e-3),
    "m": Unit("m"),
    "cm": Unit("m", 1e-2),
    "mm": Unit("m", 1e-3),
    "um": Unit("m", 1e-6),
    "µm": Unit("m", 1e-6),
    "in": Unit("m", _INCH),
    "m/s": Unit("m/s"),
    "mm/s": Unit("m/s", 1e-3),
    "cm/s": Unit("m/s", 1e-2),
    "um/s": Unit("m/s", 1e-6),
    "µm/s": Unit("m/s", 1e-6),
    "in/s": Unit("m/s", _INCH),
    "rad": Unit("rad"),
    "mrad": Unit("rad", 1e-3),
    "deg": Unit("rad", pi / 180),
    "°": Unit("rad", pi / 180),
    "turn": Unit("rad", 2 * pi),
    "rev": Unit("rad", 2 * pi),
    "rad/s": Unit("rad/s"),
    "deg/s": Unit("rad/s", pi / 180),
    "rpm": Unit("rad/s", 2 * pi / 60),
    "turn/s": Unit("rad/s", 2 * pi),
    "rev/s": Unit("rad/s", 2 * pi),
    "mrad/s": Unit("rad/s", 1e-3),
    "°/s": Unit("rad/s", pi / 180),
    "tick": Unit("tick"),
    "tick/s": Unit("tick/s"),
    "N": Unit("N"),
    "mN": Unit("N", 1e-3),
    "kN": Unit("N", 1e3),
    "kgf": Unit("N", 9.80665),
    "lbf": Unit("N", 4.4482216152605),
    "N·m": Unit("N·m"),
    "Nm": Unit("N·m"),
    "N*m": Unit("N·m"),
    "mN·m": Unit("N·m", 1e-3),
    "mNm": Unit("N·m", 1e-3),
    "Ncm": Unit("N·m", 1e-2),
    "kgf·cm": Unit("N·m", 9.80665e-2),
    "degC": Unit("degC"),
    "°C": Unit("degC"),
    "K": Unit("degC", 1.0, -273.15),
    "degF": Unit("degC", 5 / 9, -32.0),
    "1": Unit("1"),
    "%": Unit("1", 0.01),
}


def units_of(si: str) -> dict[str, float]:
    """The units of one quantity, by name, with their factor to SI; those with an offset aside."""
    return {name: u.factor for name, u in UNITS.items() if u.si == si and u.offset == 0.0}


def unit(name: str, where: str) -> Unit:
    """The unit of that name; raises ConfigError with the known ones."""
    if name not in UNITS:
        raise ConfigError(f"{where}: unit '{name}' is unknown; known: {', '.join(UNITS)}")
    return UNITS[name]


# Beyond these no quantity of a machine lies in any unit that the program reads, and below them the
# squares and ratios that a fit is made of stay far inside what a double can hold.
LEAST, MOST = 1e-15, 1e15


def sized(value: float) -> float:
    """The number itself; raises ValueError where it is too large or too small to be meant."""
    if value != 0.0 and not LEAST <= abs(value) <= MOST:
        raise ValueError(f"{value:g} is no size of a machine: 0, or {LEAST:g} to {MOST:g}")
    return value


Size = Annotated[float, AfterValidator(sized)]


def sized_not_zero(value: float) -> float:
    """As `sized`, for what may not vanish."""
    if value == 0.0:
        raise ValueError("0 would erase it")
    return sized(value)
