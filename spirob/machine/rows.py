"""Which rows of a trial are compared: not its ends, not those at saturation or too slow."""

import numpy as np

from spirob.machine.rig import RigFile

FULL = 0.98  # of the drive's limit counts as saturated
STUCK = 5  # equal extreme values in a row are a limit that nobody declared


def usable(
    name: str,
    effort: np.ndarray,
    v: np.ndarray,
    rig: RigFile,
    period: float,
    cutoff: float,
    said: list[str],
) -> np.ndarray:
    """Rows that are compared, (n,); effort unfiltered, v filtered, both in SI."""
    use = np.ones(len(v), bool)
    drop = rig.filter.drop
    if drop is None:
        drop = round(6.0 / (cutoff * period))
    use[:drop] = False
    use[len(use) - drop :] = False
    reach = max(1, round(0.5 / (cutoff * period)))  # the filter smears what happens beside a row
    full = _saturated(effort, rig)
    if full.any():
        use &= ~widened(full, reach)
        said.append(f"{name}: {full.mean():.1%} of the rows left out, where the drive saturates.")
    unit = rig.speed_scale
    if rig.rows.minimum_speed is not None:
        slow = np.abs(v) < unit * rig.rows.minimum_speed
        use &= ~slow
        said.append(f"{name}: {slow.mean():.1%} of the rows left out as too slow.")
    if rig.rows.maximum_speed is not None:
        use &= np.abs(v) <= unit * rig.rows.maximum_speed
    return use


def _saturated(effort: np.ndarray, rig: RigFile) -> np.ndarray:
    if rig.effort.limit is not None:
        limit = rig.effort.limit * rig.effort.scale
        return np.asarray(np.abs(effort) >= FULL * limit)
    full = np.zeros(len(effort), bool)
    for extreme in (effort.max(), effort.min()):
        at = np.concatenate([[0], (effort == extreme).astype(int), [0]])
        edges = np.flatnonzero(np.diff(at))
        for start, stop in zip(edges[::2], edges[1::2], strict=True):
            if stop - start >= STUCK:
                full[start:stop] = True
    return full


def widened(mask: np.ndarray, reach: int) -> np.ndarray:
    """The rows of a mask (n,) and those within `reach` of them."""
    return np.asarray(np.convolve(mask, np.ones(2 * reach + 1), "same") > 0.5)
