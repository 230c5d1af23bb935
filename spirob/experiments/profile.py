"""Why a hit near the tip is felt more: stiffness, inertia and give along the nominal straight arm.

    stiffness  k_j of the last hinge before the place                                [N·m/rad]
    mass       Σ m_i of the units from that hinge on                                 [kg]
    inertia    Σ I_i + m_i (x_i - x_j)² of them about that hinge                     [kg·m²]
    give       ∂y/∂F = Σ_{x_k < x} (x - x_k)² / k_k, what a lateral newton moves the
               place by, as long as angles are small                                 [m/N]

Hinges spring linearly and the tendons hang through, as for a body that is hit at rest.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spirob.geometry import PUBLISHED
from spirob.plant.body import hinge_stiffness, unit_inertia
from spirob.plant.nominal import Arm
from spirob.unit_table import Geometry


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
