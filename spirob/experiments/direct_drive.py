"""What the two passive experiments share, and why a hit near the tip is felt more.

The response to a contact is the difference to the same trial without it: what drifts without a
contact is none.

Stiffness, inertia and give along the nominal straight arm explain why a hit near the tip is felt
more:

    stiffness  k_j of the last hinge before the place                                [N·m/rad]
    mass       Σ m_i of the units from that hinge on                                 [kg]
    inertia    Σ I_i + m_i (x_i - x_j)² of them about that hinge                     [kg·m²]
    give       ∂y/∂F = Σ_{x_k < x} (x - x_k)² / k_k, what a lateral newton moves the
               place by, as long as angles are small                                 [m/N]

Hinges spring linearly and the tendons hang through, as for a body that is hit at rest.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from spirob.can_protocol import AMPERE_PER_COUNT, COUNTS_PER_TURN
from spirob.experiments import Side, plan
from spirob.geometry import PUBLISHED
from spirob.plant.body import hinge_stiffness, unit_inertia
from spirob.plant.rig import Arm
from spirob.unit_table import Geometry

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


def reconstructed(side: Side) -> str:
    """The signal that stands for i** [A]: a model's own, and the current that a robot measures."""
    return "current" if side.arm_current is None else "arm_current"


def per_unit(signal: str) -> float:
    """Counts of the drive (no gear) to a metre of displacement or to an ampere."""
    return COUNTS_PER_METRE if signal == "displacement" else COUNTS_PER_AMPERE


def difference(hit: Side, free: Side, signal: str, motor: int = 0) -> np.ndarray:
    """A signal with contact less the same without it, in counts of the drive (no gear)."""
    return per_unit(signal) * (hit.driven(signal, motor) - free.driven(signal, motor))


@dataclass(frozen=True)
class Profile:
    """At every place, (P,) each; units as in the head of this file."""

    stiffness: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    give: np.ndarray


def profile(
    places: Sequence[float], arm: Arm | None = None, geometry: Geometry = PUBLISHED
) -> Profile:
    """Of places in (0, 1], as shares of the arm's length from the base."""
    arm, whole = arm or Arm(), geometry.arm()
    hinge, k = whole.hinge_position, hinge_stiffness(arm, whole)
    mass, inertia = unit_inertia(arm, whole)
    centre = hinge + whole.unit_length / 2
    rows = []
    for x in geometry.length * np.asarray(places, dtype=float):
        last = int(np.flatnonzero(hinge < x)[-1])
        beyond = slice(last, None)
        about = inertia[beyond] + mass[beyond] * (centre[beyond] - hinge[last]) ** 2
        give = np.sum((x - hinge[: last + 1]) ** 2 / k[: last + 1])
        rows.append((k[last], mass[beyond].sum(), about.sum(), give))
    return Profile(*np.array(rows).T)
