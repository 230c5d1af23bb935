"""A soft coupling between gear and drum: rubber that hardens as it is wound up.

Typical 2 N·m/rad to begin with, half as much again after 0.1 rad.  While the tendon is taut this
cannot be told from a soft tendon (2 N·m/rad on a drum of 20 mm are 5 kN/m); it is kept as the
equivalent of one.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("gear_stiffness", "gear_damping")
COMPLIANCE = 1 / 2.0  # rad/(N·m)
RELAXATION = (1e-3, 3e-3)  # s: a loss factor of 0.06 to 0.19 at 10 Hz, as rubber couplings have
HARDENING = 50.0  # 1/rad²


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Stiffness with the coupling in series, and how it hardens."""
    compliance = strength * COMPLIANCE * rng.uniform(0.8, 1.2, size=SIDES)
    stiffness = 1.0 / (1.0 / nominal["gear_stiffness"] + compliance)
    return {
        "gear_stiffness": stiffness,
        "gear_damping": stiffness * rng.uniform(*RELAXATION),
        "gear_hardening": HARDENING * rng.uniform(0.7, 1.3, size=SIDES) * min(strength, 1.0),
    }
