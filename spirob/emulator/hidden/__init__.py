"""Effects that the machine has and that nobody told the model about; one file each.

A file here defines

    def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict[str, array]

which maps a strength (1 is typical) and details drawn from the seed to fields of the compiled
step's record of numbers.  Its name is the effect's name.  A value is added to what the machine
has, unless the file lists its field in `REPLACED`.  How much of each the logs show stands in
docs/lab/emulator.md, measured by tests/emulator/visibility.py.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

import numpy as np
from numpy.random import Generator

from spirob.emulator.physics.step import NUMBERS
from spirob.emulator.rig import HiddenSettings
from spirob.errors import ConfigError

Nominal = Mapping[str, np.ndarray]  # numbers of the machine without the effect, read-only


@dataclass(frozen=True)
class Hidden:
    """One effect that a machine has.

    numbers  field of the record of numbers -> what was added to it, or what replaced it
    """

    kind: str
    strength: float
    numbers: dict[str, np.ndarray]

    @property
    def plain(self) -> dict[str, object]:
        """The same as plain data."""
        values = {field: value.tolist() for field, value in self.numbers.items()}
        return {"kind": self.kind, "strength": self.strength, "numbers": values}


def effects() -> list[str]:
    """Names of all hidden effects."""
    return sorted(found.name for found in iter_modules(__path__))


def load(effect: str) -> ModuleType:
    """The module of one effect; raises ConfigError with the known names."""
    if effect not in effects():
        raise ConfigError(f"no hidden effect '{effect}'; known: {', '.join(effects())}")
    return import_module(f"{__name__}.{effect}")


def apply(
    settings: HiddenSettings, generator: Callable[[str], Generator], numbers: np.ndarray
) -> list[Hidden]:
    """Put the effects into the record of numbers; returns what each changed and by how much.

    generator  makes the source of an effect's details from its name, so that an effect is the same
               alone and in company
    Every effect is told the machine without any of them.  An effect of strength 0 changes nothing
    at all.  Where two effects replace the same number, the one written last is heard.
    """
    untouched = numbers.copy()
    untouched.setflags(write=False)
    nominal = {name: untouched[name][0] for name in NUMBERS.names or ()}
    return [
        _apply(kind, strength, generator(f"hidden {kind}"), nominal, numbers)
        for kind, strength in settings.parts
    ]


def _apply(
    kind: str, strength: float, rng: Generator, nominal: Nominal, numbers: np.ndarray
) -> Hidden:
    module = load(kind)
    if strength == 0.0:
        return Hidden(kind, strength, {})
    changes = module.numbers(strength, rng, nominal)
    for field, value in changes.items():
        assert field in (NUMBERS.names or ()), f"{kind} names no number '{field}'"
        if field in getattr(module, "REPLACED", ()):
            numbers[field][0] = value
        else:
            numbers[field][0] += value
    return Hidden(kind, strength, {field: np.asarray(value) for field, value in changes.items()})
