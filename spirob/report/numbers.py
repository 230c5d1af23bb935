"""Numbers as people read them: sensible digits, one unit, a true minus sign."""

import math
import re
from collections.abc import Sequence
from typing import TypeGuard

MISSING = "–"
SHOWN_UNIT = {"m": ("mm", 1e3), "m/s": ("mm/s", 1e3), "s": ("ms", 1e3)}
EFFORT = {"A": "current", "N": "force", "N·m": "torque", "V": "voltage"}
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
THIN_SPACE, FIRST_GROUPED = "\u202f", 1e4  # 41 000, but 4100
SMALLEST, LARGEST = 1e-3, 1e5  # outside, powers of ten are written


def shown(unit: str) -> tuple[str, float]:
    """Unit in which a quantity is shown, and the factor from SI."""
    return SHOWN_UNIT.get(unit, (unit, 1.0))


def is_number(value: object) -> TypeGuard[float]:
    """Whether there is something to print: a finite number."""
    return isinstance(value, int | float) and math.isfinite(value)


def fixed(value: float | None, decimals: int) -> str:
    """`value` with that many decimals; a dash if there is none."""
    if value is None or not is_number(value):
        return MISSING
    text = f"{value:.{decimals}f}"
    if float(text) == 0:
        text = text.lstrip("-")
    if abs(value) >= FIRST_GROUPED:
        text = f"{float(text):,.{decimals}f}".replace(",", THIN_SPACE)
    return text.replace("-", "−")


def column(values: Sequence[float | None], significant: int = 3) -> list[str]:
    """A column that lines up: as many decimals as give its median `significant` digits."""
    sizes = sorted(abs(v) for v in values if v is not None and is_number(v) and v != 0)
    if not sizes:
        return [fixed(v, 0) for v in values]
    exponent = math.floor(math.log10(sizes[len(sizes) // 2]))
    decimals = min(max(significant - 1 - exponent, 0), 6)
    return [fixed(v, decimals) for v in values]


def number(value: float | None, significant: int = 3) -> str:
    """One number alone, with powers of ten where zeros would have to be counted."""
    if value is None or not is_number(value):
        return MISSING
    if value == 0:
        return "0"
    power = _power(value)
    mantissa = value / 10**power
    decimals = max(significant - 1 - math.floor(math.log10(abs(mantissa))), 0)
    return fixed(mantissa, decimals) + _times(power)


def interval(value: float, low: float | None, high: float | None) -> tuple[str, str]:
    """A value and its interval, both to two digits of the interval's half width."""
    if low is None or high is None or not (is_number(low) and is_number(high)) or high <= low:
        return number(value), "not determined"
    power = _power(value) if value else _power(high - low)
    scale = 10**power
    half = (high - low) / 2 / scale
    decimals = min(max(1 - math.floor(math.log10(half)), 0), 6)
    v, a, b = (fixed(x / scale, decimals) for x in (value, low, high))
    return v + _times(power), f"{a} to {b}{_times(power)}"


def given(value: float | None) -> str:
    """A number that somebody chose, such as a bound: no zeros that claim precision."""
    text, times, power = number(value).partition(" × ")
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return text + times + power


def unit_text(unit: str) -> str:
    """A unit for a column of units; a dash where there is none."""
    return MISSING if unit in ("", "1") else unit


def percent(share: float | None) -> str:
    """A share of one in per cent, with a decimal only below ten."""
    if share is None or not is_number(share):
        return MISSING
    value = 100 * share
    return f"{fixed(value, 1 if 0 < abs(value) < 9.95 else 0)} %"


def prose(text: str) -> str:
    """A sentence written elsewhere, with this page's minus sign and space before per cent."""
    text = re.sub(r"(?<=\d)%", " %", text)
    return re.sub(r"(?<![\w.−-])-(?=\.?\d)", "−", text)


def _power(value: float) -> int:
    """Power of ten to take out; 0 where plain writing is easier to read."""
    if SMALLEST <= abs(value) < LARGEST:
        return 0
    return math.floor(math.log10(abs(value)))


def _times(power: int) -> str:
    return f" × 10{str(power).translate(SUPERSCRIPT)}" if power else ""
