"""Numbers and fits as people read them: sensible digits, one unit, and what a fit cannot resolve.

Correlation and null space of a fit are put into words.  Two numbers that go together can change in
step without the data noticing: only their ratio (or, where they go against each other, their
product) is known well.
"""

import math
import re
from collections.abc import Sequence
from typing import Any, TypeGuard

import numpy as np

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
    """A share of one in per cent, of two digits below ten: 58 %, 5.3 %, 0.24 %."""
    if share is None or not is_number(share):
        return MISSING
    value = 100 * share
    decimals = sum(0 < abs(value) < least for least in (9.95, 0.995))
    return f"{fixed(value, decimals)} %"


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


TOGETHER = 0.9  # correlation from which two numbers are said to go together
SHARE = 0.25  # of the unit combination, from which a number is named in it
FORCE_SCALE = ("efficiency", "damping", "inertia", "stiffness")
ALIKE = 0.8  # cosine between the weakest combination and all numbers growing in step
MILLI = {"A": "mA", "V": "mV", "N·m": "mN·m", "N": "mN"}


def pairs(resolution: dict[str, Any]) -> list[str]:
    """A sentence for every two numbers that the data hold only together, the closest first."""
    names, table = resolution["names"], resolution["correlation"]
    found = [
        (table[i][k], names[i], names[k])
        for i in range(len(names))
        for k in range(i + 1, len(names))
        if abs(table[i][k]) >= TOGETHER
    ]
    return [
        f"{spoken(a).capitalize()} and {spoken(b)} (correlation {fixed(value, 2)}): their "
        f"{'ratio' if value > 0 else 'product'} is known better than either."
        for value, a, b in sorted(found, key=lambda pair: -abs(pair[0]))
    ]


def null_space(resolution: dict[str, Any], left: float | None) -> str:
    """What the data hardly tell: the combination, what a tenth along it does, and why.

    left  RMS that the fit leaves, in the unit of the effort, for comparison
    """
    weakest, unit = resolution["weakest"], resolution["unit"]
    least, most = (_small(resolution[k], unit) for k in ("least", "most"))
    rest = "" if left is None else f"; the fit leaves {_small(left, unit)}"
    sentence = (
        f"Least known is {_combination(weakest)}: a tenth along it changes the effort by {least} "
        f"RMS, a tenth along the best known combination by {most}{rest}."
    )
    return f"{sentence} {_why(weakest)}".strip()


def _combination(weakest: dict[str, float]) -> str:
    strong = {n: v for n, v in weakest.items() if abs(v) >= SHARE * max(map(abs, weakest.values()))}
    up = [name for name, value in strong.items() if value > 0]
    down = [name for name, value in strong.items() if value <= 0]
    if len(strong) == 1:
        return f"{_listed(up + down)} alone"
    if not (up and down):
        return f"{_listed(up + down)} growing or falling together"
    return f"{_listed(up)} growing against {_listed(down)}"


def _why(weakest: dict[str, float]) -> str:
    """The reason, where it is the known one: current alone does not carry the scale of force."""
    parts = [name.rpartition(".")[2] for name in weakest]
    known = all(any(word in part for word in FORCE_SCALE) for part in parts)
    size = np.linalg.norm(list(weakest.values())) * np.sqrt(len(weakest))
    if len(parts) < 3 or not known or abs(sum(weakest.values())) / size < ALIKE:
        return ""
    return (
        "That is the scale of force: a stronger gear on a stiffer, heavier arm draws the same "
        "current. A trial with a known weight fixes it."
    )


def spoken(name: str) -> str:
    """A number's name without dots and underscores: 'motor rotor inertia' → 'rotor inertia'."""
    owner, _, own = name.rpartition(".")
    own = own.replace("_", " ")
    return own if " " in own or not owner else f"{owner} {own}"


def _listed(names: list[str]) -> str:
    texts = [spoken(name) for name in names]
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} and {texts[-1]}"


def _small(value: float, unit: str) -> str:
    if unit in MILLI and abs(value) < 1:
        return f"{number(1e3 * value)} {MILLI[unit]}"
    return f"{number(value)} {unit}"
