"""The error tree: every mistake that a user can make has a class and one clear sentence.

SpirobError
├── ConfigError        a configuration key is unknown, missing or out of range
├── DataError          a file or signal cannot be used
│   ├── MissingLog     a log that should exist does not
│   ├── MissingChannel a log lacks a channel that is needed
│   └── NothingLeft    a trial holds nothing to compare: too short, at rest, all left out
│       └── TooShort   it has fewer samples than the step needs
├── EffectError        an effect is declared wrongly
├── ExportError        a model, or a part of it, cannot leave the program
├── SimulationError    the model became non-finite or left its validity
└── HardwareError      the bus or a drive does not answer; the current is already zero

A command-line entry turns these into one sentence on stderr and exit code 2; anything else is a
bug of ours and shows its traceback.
"""

from difflib import SequenceMatcher


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

    LISTED, LONGEST = 40, 80  # names, and characters of one, that a sentence can hold

    def __init__(self, where: str, channel: str, present: list[str]):
        present = list(dict.fromkeys(present))
        nearest = sorted(present, key=lambda name: -_alike(name, channel))[: self.LISTED]
        listed = ", ".join(name[: self.LONGEST] for name in sorted(nearest)) or "none"
        more = len(present) - len(nearest)
        listed += f" and {more} more" if more else ""
        super().__init__(
            f"{where}: channel '{channel[: self.LONGEST]}' is missing; present: {listed}"
        )


def _alike(name: str, other: str) -> float:
    return SequenceMatcher(None, name[:100].lower(), other[:100].lower()).quick_ratio()


class NothingLeft(DataError):
    """A trial holds nothing that could be compared; others may do without it."""


class TooShort(NothingLeft):
    """A trial has fewer samples than the step needs."""

    def __init__(self, where: str, samples: int, needed: int, reason: str):
        super().__init__(f"{where}: {samples} samples, but {reason} needs at least {needed}")


class EffectError(SpirobError):
    """An effect is declared wrongly."""


class ExportError(SpirobError):
    """A diagnosis, or something in it, cannot be exported as asked."""


class SimulationError(SpirobError):
    """The model became non-finite or left its range of validity."""


class HardwareError(SpirobError):
    """The bus or a drive does not answer; the current is already zero."""
