"""Seconds of a log that are broken, among good ones: they are cut out, which is said.

A position is noise where most of it is faster than what is compared.  An effort is none of this
machine where it is as many times larger than in all other seconds as a unit's prefix would make it,
and the axis moves there as it does elsewhere.
"""

import numpy as np

from spirob.errors import NothingLeft
from spirob.machine.checks import widened
from spirob.machine.filtering import smooth
from spirob.units import PREFIX

NOISE = 0.5  # of a motion's variance: more beyond what is compared is no motion
FASTER = 10.0  # times the speed of all other seconds: an effort has a reason there
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


def of_one_size(
    where: str, name: str, grids: list[Grid], period: float, said: list[str]
) -> list[Grid]:
    """The pieces of a log without seconds whose effort is of another size than all others'."""
    sizes = [np.sqrt(_means(grid["effort"] ** 2, period)) for grid in grids]
    speeds = [np.sqrt(_means(np.gradient(grid["position"]) ** 2, period)) for grid in grids]
    size, speed = np.concatenate(sizes), np.concatenate(speeds)
    order = np.argsort(size)[len(size) // 2 :]  # those that are larger than half
    apart = np.flatnonzero(size[order[1:]] > PREFIX * size[order[:-1]])
    if not len(apart) or size[order[apart[0]]] == 0.0:
        return grids
    most = size[order[apart[0]]]
    calm = FASTER * float(speed[size <= most].max())
    broken = [(s > most) & (v <= calm) for s, v in zip(sizes, speeds, strict=True)]
    found, lost = _without(broken, grids, period)
    if not lost or not found:
        return grids
    said.append(
        f"{where}: '{name}' is {size.max() / most:.2g} times as large for {lost * period:.3g} s as "
        "in all others, by the same motion; they were left out."
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
