"""Which rows of a trial are compared: not its ends, not those at saturation or too slow."""

from collections import Counter

import numpy as np

from spirob.machine.rig import ANGLES, EFFORTS, LENGTHS, RigFile

FULL = 0.98  # of the drive's limit counts as saturated
STUCK = 5  # equal extreme values in a row are a limit that nobody declared
# Periods of the cutoff from an end, where acceleration as compared is good to 3 %, and to 0.1 %
EDGE, SETTLED = 2.5, 6.0
SHARE = 0.05  # of a piece that may be lost at each end for that
STILL = 1e-3  # of a log's stroke: a piece that moves by less stands


def usable(
    effort: np.ndarray,
    v: np.ndarray,
    filled: np.ndarray,
    rig: RigFile,
    period: float,
    cutoff: float,
    lost: Counter[str],
) -> np.ndarray:
    """Rows of a piece that are compared, (n,).

    effort  unfiltered, v filtered, both in SI;  filled  rows that the log does not hold
    lost    gets how many rows are left out for which reason
    """
    use = np.ones(len(v), bool)
    drop = rig.filter.drop
    if drop is None:
        drop = round(min(SETTLED, max(EDGE, SHARE * len(v) * cutoff * period)) / (cutoff * period))
    use[:drop] = False
    use[max(len(use) - drop, 0) :] = False
    reach = max(1, round(0.5 / (cutoff * period)))  # the filter smears what happens beside a row
    unit = (LENGTHS | ANGLES)[rig.position.unit]
    out = {
        ", where samples are lost": widened(filled, reach),
        ", where the drive saturates": widened(_saturated(effort, rig), reach),
    }
    if rig.rows.minimum_speed is not None:
        out[" as too slow"] = np.abs(v) < unit * rig.rows.minimum_speed
    if rig.rows.maximum_speed is not None:
        out[" as too fast"] = np.abs(v) > unit * rig.rows.maximum_speed
    for why, rows in out.items():
        lost[why] += int(rows.sum())
        use &= ~rows
    return use


def stands(q: np.ndarray, stroke: float) -> bool:
    """Whether a piece stands, its positions being (n,), where its log has a stroke."""
    return float(np.ptp(q)) <= STILL * stroke


def _saturated(effort: np.ndarray, rig: RigFile) -> np.ndarray:
    if rig.effort.limit is not None:
        limit = rig.effort.limit * EFFORTS[rig.effort.kind][rig.effort.unit]
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
