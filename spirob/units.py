"""Units of a file to SI, value_SI = factor · (value + offset), and as powers of the base units.

Besides: which numbers a machine may have.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator

from spirob.errors import ConfigError, EffectError


@dataclass(frozen=True)
class Unit:
    """What a unit is in SI."""

    si: str
    factor: float = 1.0
    offset: float = 0.0


PREFIX = 1e3  # between a unit and the one with the next prefix
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


def number(value: object) -> object:
    """The value itself; raises ValueError for what only Python counts as a number.

    True and false are no 1 and 0, and the text 1_000 is no thousand.
    """
    if isinstance(value, bool) or (isinstance(value, str) and "_" in value):
        raise ValueError(f"'{str(value)[:40].lower()}' is no number")
    return value


Size = Annotated[float, BeforeValidator(number), AfterValidator(sized)]


def sized_not_zero(value: float) -> float:
    """As `sized`, for what may not vanish."""
    if value == 0.0:
        raise ValueError("0 would erase it")
    return sized(value)


SizeNotZero = Annotated[float, BeforeValidator(number), AfterValidator(sized_not_zero)]


# exponents of metre, kilogram, second, ampere, kelvin; `reading` is whatever a sensor reports
BASE = ("m", "kg", "s", "A", "K", "reading")
NAMED: dict[str, str] = {
    "N": "kg·m/s²",
    "W": "kg·m²/s³",
    "J": "kg·m²/s²",
    "V": "kg·m²/(A·s³)",
    "Ω": "kg·m²/(A²·s³)",
    "H": "kg·m²/(A²·s²)",
    "Hz": "1/s",
    "rad": "1",
    "°C": "K",
}
SUPERSCRIPT = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
SYMBOL = re.compile(r"([A-Za-zΩ°]+)([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]*)$")

Exponents = dict[str, int]


def exponents(unit: str) -> Exponents:
    """Powers of the base units in a unit such as "N·m·s²/rad²"; an angle has none.

    Raises EffectError on a symbol that is not known.
    """
    above, _, below = unit.partition("/")
    total: Exponents = {}
    for part, sign in ((above, 1), (below.strip("()"), -1)):
        for symbol in filter(None, part.split("·")):
            for base, power in _factor(symbol, unit).items():
                total[base] = total.get(base, 0) + sign * power
    return {base: power for base, power in total.items() if power}


def rescaled(unit: str, sizes: Mapping[str, float]) -> float:
    """What one of this unit becomes when the base units are measured in others."""
    out = 1.0
    for base, power in exponents(unit).items():
        out *= sizes[base] ** power
    return out


def _factor(symbol: str, unit: str) -> Exponents:
    if symbol == "1":
        return {}
    found = SYMBOL.match(symbol)
    if found is None or (found[1] not in BASE and found[1] not in NAMED):
        raise EffectError(f"unit '{unit}': '{symbol}' is not known; write units like N·m·s²/rad²")
    power = int(found[2].translate(SUPERSCRIPT) or 1)
    parts = {found[1]: 1} if found[1] in BASE else exponents(NAMED[found[1]])
    return {base: power * times for base, times in parts.items()}
