"""The drum that a tendon winds on, and what else hangs on it.

    r = r₀ (1 + βΘ/2π + ε sin(Θ + ψ) + ε₂ sin(2Θ + ψ₂))       τ_x = r (P - k_P x)

The drum grows as it winds (β), may be out of centre (ε) and oval (ε₂).  P and k_P are a spring or
weight outside the robot that pulls at the line beside the tendon, positive winding in; x is the
length wound in.
"""

import numpy as np

from spirob.emulator.physics.compiled import SIDES, compiled

NUMBERS = {
    "winch_inertia": (SIDES,),  # J_w [kg·m²]
    "winch_radius": (SIDES,),  # r₀ [m]
    "winch_growth": (SIDES,),  # β, per turn
    "winch_eccentricity": (SIDES,),  # ε
    "winch_phase": (SIDES,),  # ψ [rad]
    "winch_oval": (SIDES,),  # ε₂
    "winch_oval_phase": (SIDES,),  # ψ₂ [rad]
    "outside_pull": (SIDES,),  # P [N]
    "outside_stiffness": (SIDES,),  # k_P [N/m]
}
STATE = {
    "winch_angle": (SIDES,),  # Θ since the arm was straight [rad]
    "winch_speed": (SIDES,),  # Ω [rad/s]
}
SCRATCH = {"radius": (SIDES,)}  # r now [m]


@compiled
def drum(p, s, w, m):
    """Measure the drum's radius as it is wound now [m]."""
    turn = s.winch_angle[m]
    wobble = p.winch_eccentricity[m] * np.sin(turn + p.winch_phase[m])
    if p.winch_oval[m] > 0.0:
        wobble += p.winch_oval[m] * np.sin(2.0 * turn + p.winch_oval_phase[m])
    growth = p.winch_growth[m] * turn / (2.0 * np.pi)
    w.radius[m] = p.winch_radius[m] * max(1.0 + growth + wobble, 0.3)
    return w.radius[m]


@compiled
def outside_torque(p, s, w, m):
    """Torque on the winch from outside the robot, positive winding in [N·m]."""
    return w.radius[m] * (p.outside_pull[m] - p.outside_stiffness[m] * s.wound[m])
