"""The stretches of a log over which a model is run from a measured state."""

import numpy as np

from spirob.machine.inverse import InverseProblem

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
