"""How far a predicted motion is from the measured one, over stretches from a measured state."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from spirob.machine.inverse import InverseProblem
from spirob.machine.motion import Motion
from spirob.score import score_interval

ROWS = {"position": "q", "speed": "v"}  # of a prediction -> of the motion


def motion_errors(
    motion: Motion, predicted: np.ndarray, blocks: np.ndarray
) -> dict[str, dict[str, Any]]:
    """ "position" and "speed": their RMS error and its 95 % interval, in SI.

    predicted  (≥ 2, n), NaN where nothing was predicted;  blocks (n,), in which errors go together
    """
    return {
        name: error(getattr(motion, field), predicted[k], blocks)
        for k, (name, field) in enumerate(ROWS.items())
    }


def error(measured: np.ndarray, predicted: np.ndarray, blocks: np.ndarray) -> dict[str, Any]:
    """RMS error and its interval over the rows that were predicted; [null, null] in one block."""
    rows = ~np.isnan(predicted)
    missed = predicted[rows] - measured[rows]
    found = score_interval(measured[rows], predicted[rows], blocks[rows])
    return {"rmse": float(np.sqrt(np.mean(missed**2))), "interval": found["rmse"]}


def guesses(motion: Motion, segments: np.ndarray) -> Mapping[str, np.ndarray]:
    """What nobody needs a model for, over the same segments, (2, n) each, NaN elsewhere.

    "standing still" where the segment begins, "keeping the speed" that it begins with
    """
    still, kept = np.full((2, len(motion.q)), np.nan), np.full((2, len(motion.q)), np.nan)
    for _, first, last in segments:
        rows, v = slice(first, last), motion.v[first]
        still[:, rows] = np.array([[motion.q[first]], [0.0]])
        kept[0, rows] = motion.q[first] + v * (motion.seconds[rows] - motion.seconds[first])
        kept[1, rows] = v
    return {"standing still": still, "keeping the speed": kept}


def numbered(segments: np.ndarray, count: int) -> np.ndarray:
    """The number of the segment in which each of `count` rows lies, (count,)."""
    found = np.zeros(count, dtype=int)
    for k, (_, first, last) in enumerate(segments):
        found[first:last] = k
    return found


WINDOW = 0.5  # s, of a short horizon that starts again from the measured motion


def horizons(problem: InverseProblem, length: float) -> np.ndarray:
    """Row where its piece begins, first row and the one behind the last of each horizon, (s, 3).

    length  of a horizon [s];  infinite: one for each piece

    Horizons lie end to end from the first to the last row of a piece that is compared, so over what
    is left out in between (a hold, a saturated drive) as well: the axis moved there, too.
    """
    found = []
    motion, k = problem.asked.motion, 0
    for recording in problem.recordings:
        for piece in recording.pieces:
            begin, used = int(motion.starts[k]), np.flatnonzero(piece.use)
            k += 1
            if len(used) < 2:
                continue
            first, end = begin + int(used[0]), begin + int(used[-1]) + 1
            rows = max(2, int(min(np.round(length / recording.period), end - first)))
            # a last row alone would be compared with itself
            found += [(begin, r, min(end, r + rows)) for r in range(first, end - 1, rows)]
    return np.array(found, dtype=int).reshape(-1, 3)
