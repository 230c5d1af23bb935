"""Do the currents belong to the motions?  What the fitted model explains of each log says it."""

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
    """Raise DataError, naming the worst log, where together they are explained by less than SENSE.

    A search for effects in such logs would find what makes up for the mistake.
    """
    rows = residual.rows
    measured = residual.measured()[rows]
    together = score(measured, measured + missed[rows]).r2
    if together < SENSE:
        logs = explained(residual, missed)
        worst = min(logs, key=logs.__getitem__)
        raise DataError(
            f"the fitted model explains {max(0.0, together):.0%} of the current's variance, "
            f"least in {worst}: {SUSPECTS}"
        )
