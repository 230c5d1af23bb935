"""What the two passive experiments share: no gearbox, equal constant currents, a straight arm.

The response to a contact is the difference to the same trial without it: what drifts without a
contact is none.
"""

from typing import Any

import numpy as np

from spirob.can_protocol import AMPERE_PER_COUNT, COUNTS_PER_TURN
from spirob.experiments.experiment import plan
from spirob.experiments.side import Side

# as conf/rig/spirob_direct.yaml
DIRECT = {
    "winch": {"gear_ratio": 1.0},
    "gains": {"velocity": 2.0, "integral": 12.0, "newton_per_ampere": 0.78, "drag": 0.25},
}
RADIUS = 0.02  # m, nominal, of the winch
DRUM_WIDTH, ALUMINIUM = 0.03, 2700.0  # m, kg/m³: the drum by its drawing
DRUM = np.pi / 2 * ALUMINIUM * DRUM_WIDTH * RADIUS**4  # kg·m², of a solid one
COUNTS_PER_METRE = COUNTS_PER_TURN / (2 * np.pi * RADIUS)  # without gear
COUNTS_PER_AMPERE = 1 / AMPERE_PER_COUNT


def direct(bandwidth: float, **drive: float) -> dict[str, Any]:
    """The rig without gearbox, its drive's current loop at a bandwidth [Hz]."""
    return {**DIRECT, "drive": {"bandwidth": float(bandwidth), **drive}}


def both(current: float) -> dict[str, Any]:
    """Both motors at the same constant current [A]."""
    held = plan("current", {"kind": "constant", "value": float(current), "blend": 0.05})
    return {"left": held, "right": held}


def difference(hit: Side, free: Side, signal: str, motor: int = 0) -> np.ndarray:
    """A signal with contact less the same without it, in counts of the drive (no gear)."""
    scale = COUNTS_PER_METRE if signal == "displacement" else COUNTS_PER_AMPERE
    return scale * (hit.driven(signal, motor) - free.driven(signal, motor))
