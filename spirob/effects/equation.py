"""Equations as text, evaluated with NumPy, and whether their units fit together."""

import re
from collections.abc import Mapping

import numpy as np

from spirob.effects.effect import Effect
from spirob.errors import EffectError

FUNCTIONS = {
    "Abs": np.abs,
    "Max": np.maximum,
    "Min": np.minimum,
    "sign": np.sign,
    "sqrt": np.sqrt,
    "exp": np.exp,
    "log": np.log,
    "sin": np.sin,
    "cos": np.cos,
    "tanh": np.tanh,
    "pi": np.pi,
}


def evaluate(
    effect: type[Effect],
    text: str,
    numbers: Mapping[str, float],
    arguments: Mapping[str, np.ndarray | float],
) -> np.ndarray:
    """Value of an effect's equation for numbers by field name and arguments by name.

    Raises EffectError when the text is no expression in those names.
    """
    symbols = {about.symbol: numbers[name] for name, about in effect.parameters().items()}
    names = {**FUNCTIONS, **arguments, **symbols, "__builtins__": {}}
    try:
        value = eval(compile(text, "<equation>", "eval"), names)
    except (SyntaxError, NameError, TypeError) as wrong:
        known = ", ".join([*symbols, *arguments, *FUNCTIONS])
        raise EffectError(f"equation '{text}': {wrong}; it may use {known}") from wrong
    return np.asarray(value, dtype=float) * np.ones(_length(arguments))


def _length(arguments: Mapping[str, np.ndarray | float]) -> int:
    return max((np.size(v) for v in arguments.values()), default=1)


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


def size(unit: str, sizes: Mapping[str, float]) -> float:
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
