"""The line that a tendon is made of: how it answers a stretch, and how it creeps.

    T(e) = K [e - (1-κ) ε₀ (1 - exp(-e/ε₀))]   e > 0       T = κ K e   e ≤ 0 (slack, for the solver)
    ẋ_m = (C_m T - x_m)/τ_m                                 e = x - Δl - Σ x_m

A braid first straightens its strands over a toe ε₀, during which it has only the share κ of its
stiffness; without a toe it is a plain spring.  Under load it grows by C_m T after each time τ_m.
Sources: toe region of braided and polymer ropes (exponential form of Fung 1967); creep of UHMWPE
line in data sheets, a Prony series of compliances.
"""

import numpy as np

from spirob.emulator.physics.compiled import SIDES, compiled

CREEP_TERMS = 2
TOE_SHARE = 0.1  # κ
NUMBERS = {
    "tendon_stiffness": (SIDES,),  # K [N/m]
    "tendon_damping": (SIDES,),  # c [N·s/m]
    "tendon_toe": (SIDES,),  # ε₀ [m]
    "tendon_creep": (SIDES, CREEP_TERMS),  # C [m/N]
    "tendon_creep_time": (CREEP_TERMS,),  # τ [s]
}
STATE = {"tendon_growth": (SIDES, CREEP_TERMS)}  # x_m [m]
SCRATCH: dict[str, tuple[int, ...]] = {}


@compiled
def grown(s, m):
    """By how much the line has crept [m]."""
    total = 0.0
    for n in range(CREEP_TERMS):
        total += s.tendon_growth[m, n]
    return total


@compiled
def elastic(p, m, stretch):
    """Tension of the stretched line [N] and its slope [N/m]."""
    stiffness, toe = p.tendon_stiffness[m], p.tendon_toe[m]
    if toe <= 0.0:
        return stiffness * stretch, stiffness
    if stretch <= 0.0:
        return TOE_SHARE * stiffness * stretch, TOE_SHARE * stiffness
    fold = (1.0 - TOE_SHARE) * np.exp(-stretch / toe)
    tension = stiffness * (stretch - toe * (1.0 - TOE_SHARE - fold))
    return tension, stiffness * (1.0 - fold)


@compiled
def grow(p, s, h):
    """Let the lines creep under the tension of the step."""
    for m in range(SIDES):
        for n in range(CREEP_TERMS):
            if p.tendon_creep[m, n] > 0.0:
                follow = 1.0 - np.exp(-h / p.tendon_creep_time[n])
                target = p.tendon_creep[m, n] * s.tension[m]
                s.tendon_growth[m, n] += follow * (target - s.tendon_growth[m, n])
