"""Do the currents belong to the motions?  What the fitted model explains of each log says it."""

from statistics import median

import numpy as np

from spirob.errors import DataError
from spirob.identify.residual import Residual
from spirob.score import score

SENSE = 0.3  # R² below which the currents do not belong to this motion
SUSPECTS = "are the columns of the two motors exchanged, a sign or a unit wrong?"


def explained(residual: Residual, missed: np.ndarray) -> dict[str, float]:
    """R² of the driven motors' current, log by log; logs that command every current have none.

    missed  model minus measurement of all logs, as `residual` gives it [A]
    """
    measured, found = residual.measured(), {}
    for k, trial in enumerate(residual.trials):
        own = slice(residual.edges[k], residual.edges[k + 1])
        rows = residual.rows[own]
        if rows.any():
            want = measured[own][rows]
            found[trial.name] = score(want, want + missed[own][rows]).r2
    return found


def refuse_senseless(residual: Residual, missed: np.ndarray) -> None:
    """Raise DataError, naming the worst log, where less than SENSE of them is explained.

    Of all together, or of the median log: numbers that are fitted to exchanged motors explain how
    much one log asks beside another, and hardly what happens in either.  A search for effects in
    such logs would find what makes up for the mistake.
    """
    rows = residual.rows
    measured = residual.measured()[rows]
    logs = explained(residual, missed)
    told = min(score(measured, measured + missed[rows]).r2, median(logs.values()))
    if told < SENSE:
        worst = min(logs, key=logs.__getitem__)
        raise DataError(
            f"the fitted model explains {max(0.0, told):.0%} of the current's variance, "
            f"least in {worst}: {SUSPECTS}"
        )
