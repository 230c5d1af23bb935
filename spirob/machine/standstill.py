"""Rows at which the axis stands, where dry friction may take any value below its level.

A law of friction by speed says nothing there, yet such rows can outnumber the moving ones: whatever
effect follows the drift of a hold would then be named in place of none.
"""

from dataclasses import replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from spirob.machine.recording import Recording

HOLD = 0.1  # s; a reversal is shorter, and says much of friction
NOISE = 5.0  # rest speeds that a derivative's noise may reach while the axis stands
LEAST = 0.2  # of the rows have to be left, else the log is one of holds and is used as it is


def without_holds(
    recordings: list[Recording], rest_speed: float
) -> tuple[list[Recording], list[str]]:
    """The trials without the rows at standstill, and a sentence for each that lost some."""
    kept, said = [], []
    for recording in recordings:
        pieces, used, left = [], 0, 0
        for piece in recording.pieces:
            use = piece.use & ~holds(piece.v, rest_speed, recording.period)
            pieces.append(replace(piece, use=use))
            used, left = used + int(piece.use.sum()), left + int(use.sum())
        pieces = recording.worth(pieces)
        if not pieces or left < LEAST * used:
            kept.append(recording)
            said.append(f"{recording.name}: the axis stands most of the time.")
            continue
        kept.append(replace(recording, pieces=pieces))
        if left < used:
            said.append(
                f"{recording.name}: {1 - left / used:.1%} of the rows left out, where the axis "
                "stands (rows.standstill: keep would use them)."
            )
    return kept, said


def holds(v: np.ndarray, rest_speed: float, period: float) -> np.ndarray:
    """Rows of an even grid that belong to a standstill of at least `HOLD`, (n,), v the speed."""
    window = max(1, round(HOLD / period))
    still = np.abs(uniform_filter1d(v, window)) < rest_speed
    still &= np.abs(v) < NOISE * rest_speed
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]])))
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        if stop - start < window:
            still[start:stop] = False
    return still
