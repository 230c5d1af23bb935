"""Where a residual lies, as plain data: its regimes, orders, lateness, and what foretells it."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from spirob.diagnosis.atlas import atlas, worst
from spirob.diagnosis.depends import dependence, told
from spirob.diagnosis.lateness import lateness
from spirob.diagnosis.situations import situations
from spirob.diagnosis.spectrum import orders
from spirob.identify.residual import Residual

KEYS = ("atlas", "atlas_sentences", "atlas_orders", "atlas_lateness", "depends")


def survey(residual: Residual, changes: Mapping[str, float], values: np.ndarray) -> dict[str, Any]:
    """What the diagnosis says of the base model's residual; its keys are `KEYS`.

    changes  numbers of the base model;  values  what it leaves of the effort alone, (N,)
    """
    regimes = atlas(residual, values, situations(residual, changes))
    pieces = residual.stretches()
    waves = orders(pieces, values)
    alone = dependence(residual, values)
    return {
        "atlas": [r.as_dict() for r in regimes],
        "atlas_sentences": worst(regimes, residual.effort),
        "atlas_orders": [w.as_dict() for w in waves],
        "atlas_lateness": lateness(pieces, values),
        "depends": {"sentence": told(alone, waves), "alone": alone},
    }
