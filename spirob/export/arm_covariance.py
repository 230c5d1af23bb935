"""How the numbers of a corrected arm vary together: those of its effects and those fitted before.

The diagnosis states an interval for each number.  What goes with what follows here from the trials
that were fitted: slopes of the same residual, and its covariance by blocks, to first order where
the model stands.
"""

from collections.abc import Sequence

import numpy as np
import yaml

from spirob.errors import SpirobError
from spirob.export.arm import CONFIG, TRACES, CorrectedArm
from spirob.identify.descent import slopes_ahead
from spirob.identify.intervals import block_covariance
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Filter, Residual
from spirob.identify.scaling import Scaling
from spirob.logs import read_parquet

STEP = 0.01  # of a scaled number
TRAIN = "train"


def correlation_of(model: CorrectedArm, names: Sequence[str]) -> np.ndarray | None:
    """Correlation of these numbers, (n, n); None where the trials that were fitted are not there.

    A number that the trials do not tell correlates with none.
    """
    residual, scale = _residual(model) or (None, 0.0)
    if residual is None or not names:
        return None
    scaling, table = Scaling(residual.table, names), residual.table
    own = {n: model.changes.get(n, float(table.values[table.position(n)])) for n in names}
    fixed = {n: v for n, v in model.changes.items() if n not in own}
    u = scaling.scaled(own)
    value = residual({**fixed, **scaling.physical(u)})
    slopes = slopes_ahead(residual, scaling, u, fixed, value, STEP)
    covariance = block_covariance(slopes, value, residual.edges, scale, residual.block)
    covariance = scaling.slopes(u) @ covariance @ scaling.slopes(u).T
    deviation = np.sqrt(np.diag(covariance))
    known = np.isfinite(deviation) & (deviation > 0.0)
    deviation = np.where(known, deviation, 1.0)
    found = np.where(np.outer(known, known), covariance / np.outer(deviation, deviation), 0.0)
    np.fill_diagonal(found, 1.0)
    return np.asarray(np.clip(found, -1.0, 1.0))


def _residual(model: CorrectedArm) -> tuple[Residual, float] | None:
    """The residual of the trials that were fitted, and the scale of its robust loss [A]."""
    if model.data is None:
        return None
    try:
        config = yaml.safe_load((model.data / CONFIG).read_text(encoding="utf-8"))
        said = config["identify"]
        names = [t["name"] for t in config["experiment"]["trials"] if t["role"] == TRAIN]
        trials = [
            Measurement.from_trace(read_parquet(model.data / TRACES / f"{name}.parquet"))
            for name in names
        ]
        settings = Filter(**said["filter"]), str(said["current"]), float(said["length"])
        scale = float(said["scale"])
    except (SpirobError, OSError, KeyError, TypeError, ValueError, yaml.YAMLError):
        return None
    return (Residual(model.plant(), trials, *settings), scale) if trials else None
