"""What the magnets make of a current, and what they do without one.

    τ = k_t i / (1 + (|i|/i_s)ⁿ)^(1/n)
    k_t = k_t0 (1 + Σ ρ_j sin(ν_j θ + ψ_j)) / (1 + α_B ϑ)

The ripple ρ belongs to flux, thus to torque and back-EMF alike; the iron saturates over i_s, and
warm magnets (ϑ above the room) are weaker.  Cogging is torque without current, a sum of harmonics
of the rotor angle θ, the lowest of them per turn of the *winch* (an eccentric gear).

Sources: Hanselman, "Brushless Permanent Magnet Motor Design" (ripple, cogging); Fröhlich's curve
with a free knee for saturation; magnet data sheets, which are linear in temperature to first order
(the reciprocal agrees to that order and stays positive in a stalled motor).
"""

import numpy as np

from spirob.emulator.physics.compiled import SIDES, compiled

HARMONICS = 5
NUMBERS = {
    "torque_constant": (SIDES,),  # k_t0 = k_e [N·m/A]
    "magnet_heating": (),  # α_B [1/K]
    "ripple": (SIDES, HARMONICS),  # ρ [-]
    "ripple_order": (SIDES, HARMONICS),  # ν, per rotor turn
    "ripple_phase": (SIDES, HARMONICS),  # ψ [rad]
    "saturation": (SIDES,),  # 1/i_s [1/A]
    "saturation_power": (),  # n [-]
    "cogging_torque": (SIDES, HARMONICS),  # amplitude at the rotor [N·m]
    "cogging_order": (SIDES, HARMONICS),  # per rotor turn
    "cogging_phase": (SIDES, HARMONICS),  # [rad]
}
STATE = {"warmth": (SIDES,)}  # ϑ, of the winding and its magnets above the room [K]
SCRATCH: dict[str, tuple[int, ...]] = {}


@compiled
def torque_constant(p, s, m):
    """k_t of the magnets as warm as they are, where the rotor stands [N·m/A]."""
    flux = p.torque_constant[m] / (1.0 + p.magnet_heating * s.warmth[m])
    ripple = 0.0
    for n in range(HARMONICS):
        if p.ripple[m, n] > 0.0:
            angle = p.ripple_order[m, n] * s.rotor_angle[m] + p.ripple_phase[m, n]
            ripple += p.ripple[m, n] * np.sin(angle)
    return flux * (1.0 + ripple)


@compiled
def saturated(p, current, m):
    """The share of its torque that a current keeps in iron that saturates [-]."""
    if p.saturation[m] <= 0.0:
        return 1.0
    n = p.saturation_power
    return (1.0 + (abs(current) * p.saturation[m]) ** n) ** (-1.0 / n)


@compiled
def cogging(p, s, m):
    """Torque of the magnets and of the eccentric gear at the rotor [N·m]."""
    total = 0.0
    for n in range(HARMONICS):
        if p.cogging_torque[m, n] > 0.0:
            angle = p.cogging_order[m, n] * s.rotor_angle[m] + p.cogging_phase[m, n]
            total += p.cogging_torque[m, n] * np.sin(angle)
    return total
