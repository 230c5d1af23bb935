"""All logs of a diagnosis, filtered alike; those of which nothing is left are left out and said."""

from collections.abc import Callable, Sequence
from typing import TypeVar

from spirob.errors import DataError, NothingLeft
from spirob.machine.recording import Recording

Log = TypeVar("Log")


def filtered_alike(
    read: Callable[[Log, float | None], Recording], train: Sequence[Log], test: Sequence[Log]
) -> tuple[list[Recording], list[Recording]]:
    """The trials for training and those held out, by the lowest cutoff of the training trials.

    read  makes a recording of a log, with the cutoff [Hz] that is given

    Raises DataError where no training log is left, and what `read` raises but NothingLeft.
    """
    trials, said = _left(read, train, None)
    if not trials:
        raise DataError("; ".join(said) or "a diagnosis needs at least one training log")
    cutoff = min(trial.cutoff for trial in trials)
    if any(trial.cutoff != cutoff for trial in trials):
        trials, said = _left(read, train, cutoff)
    held, more = _left(read, test, cutoff)
    trials[0].said.extend(f"{text}; the log is left out." for text in [*said, *more])
    return trials, held


def _left(
    read: Callable[[Log, float | None], Recording], logs: Sequence[Log], cutoff: float | None
) -> tuple[list[Recording], list[str]]:
    """The recordings of which something is left, and what is said of the others."""
    found, said = [], []
    for log in logs:
        try:
            found.append(read(log, cutoff))
        except NothingLeft as error:
            said.append(str(error))
    return found, said
