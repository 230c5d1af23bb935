"""Effects that the machine has and that nobody told the model about; one file each.

A file here defines

    def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict[str, array]

which maps a strength (1 is typical) and details drawn from the seed to fields of the compiled
step's record of numbers.  Its name is the effect's name.  A value is added to what the machine
has, unless the file lists its field in `REPLACED`.
"""

from dataclasses import dataclass
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

import numpy as np

from spirob.emulator.physics.layout import NUMBERS
from spirob.emulator.rig import HiddenSettings
from spirob.errors import ConfigError


@dataclass(frozen=True)
class Nominal:
    """What an effect may ask about the machine.

    numbers  the record of the machine without the effect, read-only
    """

    numbers: np.ndarray

    def __getitem__(self, field: str) -> np.ndarray:
        return self.numbers[field][0]


def effects() -> list[str]:
    """Names of all hidden effects."""
    return sorted(found.name for found in iter_modules(__path__))


def load(effect: str) -> ModuleType:
    """The module of one effect; raises ConfigError with the known names."""
    if effect not in effects():
        raise ConfigError(f"no hidden effect '{effect}'; known: {', '.join(effects())}")
    return import_module(f"{__name__}.{effect}")


def apply(
    settings: HiddenSettings, rng: np.random.Generator, numbers: np.ndarray
) -> dict[str, np.ndarray]:
    """Put the effect into the record of numbers; returns what was changed and by how much."""
    module = load(settings.effect)
    untouched = numbers.copy()
    untouched.setflags(write=False)
    changes = module.numbers(settings.strength, rng, Nominal(untouched))
    for field, value in changes.items():
        assert field in (NUMBERS.names or ()), f"{settings.effect} names no number '{field}'"
        if field in getattr(module, "REPLACED", ()):
            numbers[field][0] = value
        else:
            numbers[field][0] += value
    return {field: np.asarray(value) for field, value in changes.items()}
