"""Training and held-out data where only one log was given: blocks, and a sentence that says so."""

from dataclasses import replace

import numpy as np

from spirob.errors import TooShort
from spirob.machine.recording import Recording

KEPT = 0.3  # of the log is kept aside, as one block at its end
SHORTEST = 4.0  # s of a log that is to be divided


def split(
    train: list[Recording], test: list[Recording]
) -> tuple[list[Recording], list[Recording], list[str]]:
    """The logs as they are, or the end of each training log as held-out block.

    Raises TooShort where nothing can be held out.
    """
    if test:
        return train, test, []
    kept, held = [], []
    for recording in train:
        long = sum(len(p.q) for p in recording.pieces)
        needed = round(SHORTEST / recording.period)
        if long < needed:
            raise TooShort(recording.name, long, needed, "a log that is to be divided")
        counted = np.cumsum(np.concatenate([p.use for p in recording.pieces]))
        late = counted > (1.0 - KEPT) * counted[-1]
        kept.append(_part(recording, recording.name, ~late))
        held.append(_part(recording, f"{recording.name} (end)", late))
    said = [
        f"No held-out log was given: the last {KEPT:.0%} of each training log was kept aside, and "
        "the rest is judged on blocks. Blocks of one trial share its start, load and temperature."
    ]
    return kept, held, said


def _part(recording: Recording, name: str, rows: np.ndarray) -> Recording:
    """The recording with some rows compared only, a mask over all pieces in a row."""
    ends = np.cumsum([len(p.q) for p in recording.pieces])
    masks = np.split(rows, ends[:-1])
    pieces = [replace(p, use=p.use & m) for p, m in zip(recording.pieces, masks, strict=True)]
    return replace(recording, name=name, pieces=recording.worth(pieces))
