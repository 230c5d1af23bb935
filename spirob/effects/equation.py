"""Equations as text, evaluated with NumPy: the second statement that a kernel is held against."""

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
