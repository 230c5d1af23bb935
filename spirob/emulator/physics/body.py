"""The arm as a planar chain: inertia, gravity, and the moment in every hinge.

With absolute angles φ the kinetic energy is ½ΣA_ij cos(φ_i - φ_j) φ̇_i φ̇_j, where below the
diagonal A_ij = B_i L_j: B_i = m_i c_i + L_i Σ_{k>i} m_k is the first moment of everything that
hangs on hinge i along unit i.  Then

    Σ_j A_ij cos(φ_i - φ_j) φ̈_j = -Σ_j A_ij sin(φ_i - φ_j) φ̇_j² + B_i e'_i·g + moments

with e'_i = (-sin φ_i, cos φ_i).  Because A is separable all sums take one pass over the chain.

Moment of a hinge, u = q - q_rest, x = u/q_stop:

    -k u (1 + a|x|ⁿ) - Σ_m k g_m (u - e_m) - d q̇       ė_m = (u - e_m)/τ_m

(hardening a, n and creep g_m, τ_m are zero in a plain arm), and beyond ±q_stop the faces touch:
a stiff spring with damping.  The damping is kept while faces part (they stick a little, for half
a millisecond): cutting it off there makes a packed arm rattle at the step's own frequency.
"""

import numpy as np

from spirob.emulator.physics import HINGES, compiled

CREEP_ARMS = 3
NUMBERS = {
    "length": (HINGES,),  # of the units [m]
    "first_moment": (HINGES,),  # B [kg·m]
    "inertia": (HINGES,),  # A_ii [kg·m²]
    "gravity": (2,),  # [m/s²]
    "stiffness": (HINGES,),  # k [N·m/rad]
    "damping": (HINGES,),  # d [N·m·s/rad]
    "rest_angle": (HINGES,),  # q_rest [rad]
    "hardening": (HINGES,),  # a [-]
    "hardening_power": (),  # n [-]
    "creep_share": (CREEP_ARMS, HINGES),  # g [-]
    "creep_time": (CREEP_ARMS,),  # τ [s]
    "stop_angle": (HINGES,),  # [rad]
    "stop_stiffness": (HINGES,),  # [N·m/rad]
    "stop_damping": (HINGES,),  # [N·m·s/rad]
}
STATE = {
    "phi": (HINGES,),  # [rad]
    "rate": (HINGES,),  # [rad/s]
    "creep": (CREEP_ARMS, HINGES),  # e [rad]
}
SCRATCH = {
    "cosine": (HINGES,),
    "sine": (HINGES,),
    "q": (HINGES,),
    "q_rate": (HINGES,),
    "moment": (HINGES,),  # of each hinge at the end of the step if its rate stayed [N·m]
    "implicit": (HINGES,),  # how that moment falls with the new rate, times h [kg·m²]
    "force": (HINGES,),  # generalised force on φ [N·m]
}


@compiled
def pose(s, w):
    """Sines, cosines, hinge angles and rates of the present state."""
    before = 0.0
    before_rate = 0.0
    for i in range(HINGES):
        w.cosine[i] = np.cos(s.phi[i])
        w.sine[i] = np.sin(s.phi[i])
        w.q[i] = s.phi[i] - before
        w.q_rate[i] = s.rate[i] - before_rate
        before = s.phi[i]
        before_rate = s.rate[i]


@compiled
def inertia(p, w):
    """Start the system matrix with the mass matrix."""
    for i in range(HINGES):
        w.u[i, 0] = -p.first_moment[i] * w.sine[i]
        w.u[i, 1] = p.first_moment[i] * w.cosine[i]
        w.v[i, 0] = -p.length[i] * w.sine[i]
        w.v[i, 1] = p.length[i] * w.cosine[i]
        w.diagonal[i] = p.inertia[i]


@compiled
def weight_and_spin(p, s, w):
    """Start the generalised force with gravity and the velocity terms."""
    x, y = 0.0, 0.0
    for i in range(HINGES):
        c, sn = w.cosine[i], w.sine[i]
        w.force[i] = p.first_moment[i] * (p.gravity[1] * c - p.gravity[0] * sn - (sn * x - c * y))
        square = s.rate[i] * s.rate[i]
        x += p.length[i] * c * square
        y += p.length[i] * sn * square
    x, y = 0.0, 0.0
    for k in range(HINGES):
        i = HINGES - 1 - k
        c, sn = w.cosine[i], w.sine[i]
        w.force[i] -= p.length[i] * (sn * x - c * y)
        square = s.rate[i] * s.rate[i] * p.first_moment[i]
        x += c * square
        y += sn * square


@compiled
def hinges(p, s, w, h):
    """Elastic, creeping, damping and stop moment of every hinge, linearised for the step."""
    for i in range(HINGES):
        u = w.q[i] - p.rest_angle[i]
        rate = w.q_rate[i]
        k = p.stiffness[i]
        harder = 0.0
        if p.hardening[i] > 0.0:
            harder = p.hardening[i] * abs(u / p.stop_angle[i]) ** p.hardening_power
        slope = k * (1.0 + (1.0 + p.hardening_power) * harder)
        moment = -k * u * (1.0 + harder)
        for m in range(CREEP_ARMS):
            share = k * p.creep_share[m, i]
            moment -= share * (u - s.creep[m, i])
            slope += share
        moment -= (h * slope + p.damping[i]) * rate
        implicit = h * slope + p.damping[i]
        side = 1.0 if w.q[i] > 0.0 else -1.0
        beyond = side * w.q[i] - p.stop_angle[i]
        stiff = h * p.stop_stiffness[i] + p.stop_damping[i]
        if beyond > 0.0 or beyond + h * side * rate > 0.0:
            moment -= side * (p.stop_stiffness[i] * beyond + stiff * side * rate)
            implicit += stiff
        w.moment[i] = moment
        w.implicit[i] = h * implicit


@compiled
def creep(p, s, w, h):
    """Let the creeping arms follow; exact for a hinge that stands."""
    for m in range(CREEP_ARMS):
        follow = 1.0 - np.exp(-h / p.creep_time[m])
        for i in range(HINGES):
            if p.creep_share[m, i] > 0.0:
                s.creep[m, i] += follow * (w.q[i] - p.rest_angle[i] - s.creep[m, i])
