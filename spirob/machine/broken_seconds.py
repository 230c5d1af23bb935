"""Seconds of a log whose position is broken, among good ones: they are cut out, which is said.

A position is noise where most of it is faster than what is compared.
"""

import numpy as np

from spirob.errors import NothingLeft
from spirob.machine.checks import widened
from spirob.machine.filtering import smooth

NOISE = 0.5  # of a motion's variance: more beyond what is compared is no motion
PIECE = 0.5  # s, of what is left between broken seconds
Grid = dict[str, np.ndarray]


def followed(
    where: str, name: str, grids: list[Grid], edge: float, period: float, said: list[str]
) -> list[Grid]:
    """The pieces of a log without seconds in which its position is noise.

    Noise is what is faster than what is compared, `edge` [Hz], where it is more than half of the
    whole motion's variance.  Raises NothingLeft where that is most of the log.
    """
    places = [grid["position"] for grid in grids]
    rows = sum(map(len, places))
    motion = sum(float(np.sum((q - q.mean()) ** 2)) for q in places) / rows
    fast = [_means((q - smooth(q, edge, period)) ** 2, period) for q in places]
    noise = [(motion > 0.0) & (means > NOISE * motion) for means in fast]
    found, lost = _without(noise, grids, period)
    if 2 * lost > rows or not found:
        raise NothingLeft(
            f"{where}: '{name}' is no motion that can be followed: in {lost / rows:.0%} of the "
            f"log most of its variance lies above {edge:.3g} Hz; is it another column, an axis "
            "that stands, or an angle that turns too fast for these rows?"
        )
    if lost:
        said.append(
            f"{where}: '{name}' is noise, or faster than what is compared, for "
            f"{lost * period:.3g} s, which were left out."
        )
    return found


def _means(values: np.ndarray, period: float) -> np.ndarray:
    """Of each second of a piece, the last one shorter, (seconds,)."""
    blocks = _seconds(len(values), period)
    return np.asarray(np.bincount(blocks, values) / np.bincount(blocks))


def _seconds(rows: int, period: float) -> np.ndarray:
    return np.arange(rows) // max(1, round(1.0 / period))


def _without(broken: list[np.ndarray], grids: list[Grid], period: float) -> tuple[list[Grid], int]:
    """The pieces without broken seconds and those beside them, and how many rows these have."""
    found, lost = [], 0
    for grid, bad in zip(grids, broken, strict=True):
        rows = widened(bad, 1)[_seconds(len(grid["time"]), period)]
        lost += int(rows.sum())
        parts = np.split(np.arange(len(rows)), np.flatnonzero(np.diff(rows.astype(int))) + 1)
        kept = [p for p in parts if not rows[p[0]] and (not bad.any() or len(p) * period > PIECE)]
        found += [{name: values[part] for name, values in grid.items()} for part in kept]
    return found, lost
