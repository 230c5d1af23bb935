"""Which logs of the arm are fitted, which choose, and which are held out."""

from collections.abc import Sequence
from dataclasses import dataclass

from spirob.machine.splitting import KEPT

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
