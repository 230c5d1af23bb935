"""The error tree: every mistake that a user can make has a class and one clear sentence.

SpirobError
├── ConfigError        a configuration key is unknown, missing or out of range
├── DataError          a file or signal cannot be used
│   ├── MissingLog     a log that should exist does not
│   ├── MissingChannel a log lacks a channel that is needed
│   └── NothingLeft    a trial holds nothing to compare: too short, at rest, all left out
│       └── TooShort   it has fewer samples than the step needs
├── EffectError        an effect is declared wrongly
├── SimulationError    the model became non-finite or left its validity
└── HardwareError      the bus or a drive does not answer; the current is already zero

A command-line entry turns these into one sentence on stderr and exit code 2; anything else is a
bug of ours and shows its traceback.
"""


class SpirobError(Exception):
    """Root of all errors that are told to the user as a sentence."""


class ConfigError(SpirobError):
    """A configuration key is unknown, missing or out of range."""


class DataError(SpirobError):
    """A file or signal cannot be used as it is."""


class MissingLog(DataError):
    """A log that should exist does not."""


class MissingChannel(DataError):
    """A log lacks a channel that is needed."""

    def __init__(self, where: str, channel: str, present: list[str]):
        listed = ", ".join(sorted(present)) or "none"
        super().__init__(f"{where}: channel '{channel}' is missing; present: {listed}")


class NothingLeft(DataError):
    """A trial holds nothing that could be compared; others may do without it."""


class TooShort(NothingLeft):
    """A trial has fewer samples than the step needs."""

    def __init__(self, where: str, samples: int, needed: int, reason: str):
        super().__init__(f"{where}: {samples} samples, but {reason} needs at least {needed}")


class EffectError(SpirobError):
    """An effect is declared wrongly."""


class SimulationError(SpirobError):
    """The model became non-finite or left its range of validity."""


class HardwareError(SpirobError):
    """The bus or a drive does not answer; the current is already zero."""
