"""Which logs of the arm are fitted, which choose, which are held out; blocks where there is one.

The arm's state in the midst of a log is not in the log, so the model plays a log from rest: all
that comes before a block is played, too, but counts for nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from spirob.errors import DataError, TooShort
from spirob.identify.measurement import Measurement
from spirob.identify.residual import BLOCK
from spirob.machine.selection import KEPT, SHORTEST_DIVIDED

CHOOSING = 0.2  # of a log that is the only one to fit: it chooses between effects


@dataclass(frozen=True)
class Part:
    """A part of a log, called by its number, from one share of its length up to another."""

    log: int
    begin: float = 0.0
    end: float = 1.0

    @property
    def whole(self) -> bool:
        """No block of it, but all."""
        return (self.begin, self.end) == (0.0, 1.0)


def roles(train: Sequence[int], test: Sequence[int]) -> tuple[dict[str, list[Part]], list[str]]:
    """Parts of logs by role, and sentences that say where a log was divided.

    The last third of the training logs chooses between effects; of a single one its last block
    does.  Where nothing is held out the end of each training log is.
    """
    end = 1.0 if test else 1.0 - KEPT
    said = []
    if len(train) > 1:
        cut = len(train) - max(1, len(train) // 3)
        fitted = [Part(log, 0.0, end) for log in train[:cut]]
        choosing = [Part(log, 0.0, end) for log in train[cut:]]
    else:
        between = end - CHOOSING
        fitted = [Part(log, 0.0, between) for log in train]
        choosing = [Part(log, between, end) for log in train]
        said.append(
            f"One training log was given: {between:.0%} of it are fitted, the next {CHOOSING:.0%} "
            "choose between effects."
        )
    held = [Part(log) for log in test] or [Part(log, end, 1.0) for log in train]
    if not test:
        said.append(
            f"No held-out log was given: the last {KEPT:.0%} of each training log was kept aside."
        )
    if said:
        said.append("Blocks of one trial share its start, load and temperature.")
    return {"train": fitted, "validate": choosing, "heldout": held}, said


def block(trial: Measurement, part: Part) -> Measurement:
    """The trial up to the end of its part; what comes before the part is not compared.

    Raises TooShort where a log that is to be divided is shorter than 4 s, DataError where less
    than half a second of the part is compared.
    """
    cycles = len(trial.current)
    if part.whole:
        return trial
    if cycles < 1e3 * SHORTEST_DIVIDED:
        raise TooShort(
            trial.name, cycles, round(1e3 * SHORTEST_DIVIDED), "a log that is to be divided"
        )
    begin, end = round(part.begin * cycles), round(part.end * cycles)
    part_of_it = replace(
        trial.until(end),
        name=f"{trial.name} ({100 * part.begin:.0f} to {100 * part.end:.0f} %)",
    )
    return replace(part_of_it, use=_from(part_of_it, begin))


def _from(trial: Measurement, begin: int) -> np.ndarray | None:
    if begin == 0:
        return trial.use
    cycles = len(trial.current)
    use = np.ones(cycles, bool) if trial.use is None else trial.use.copy()
    use[:begin] = False
    if 1e-3 * np.count_nonzero(use) < BLOCK:
        raise DataError(
            f"{trial.name}: of its part from {1e-3 * begin:.3g} to {1e-3 * cycles:.3g} s less "
            f"than {BLOCK:g} s are left after the row filters"
        )
    return use
