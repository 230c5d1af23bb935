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
        piece = max(recording.pieces, key=lambda p: len(p.q))
        cut = round((1.0 - KEPT) * len(piece.q))
        index = np.arange(len(piece.q))
        others = [p for p in recording.pieces if p is not piece]
        early = replace(piece, use=piece.use & (index < cut))
        late = replace(piece, use=piece.use & (index >= cut))
        kept.append(replace(recording, pieces=[*others, early]))
        held.append(replace(recording, name=f"{recording.name} (end)", pieces=[late]))
    said = [
        f"No held-out log was given: the last {KEPT:.0%} of each training log was kept aside, and "
        "the rest is judged on blocks. Blocks of one trial share its start, load and temperature."
    ]
    return kept, held, said
