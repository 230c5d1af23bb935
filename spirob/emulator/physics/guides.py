"""Friction of a tendon on the guides that it is led through.

A tendon that slides round a guide through the wrap angle ω_k loses tension like a rope on a
capstan.  A guide sits between two hinges and is wrapped by half of each, so its wrap is
(|q_k| + |q_{k+1}|)/2 and all guides together have Σ|q|.  From the winch to the tip

    T_k = T_{k-1} exp(-μ_k ω_k z_k)            T_{-1} = T at the winch

z ∈ [-1, 1] is the state of the asperities: +1 while the tendon slides towards the winch, -1 while
it slides back, and between them it sticks elastically over a slip distance δ (Dahl):

    ż_k = (ṡ_k - |ṡ_k| z_k)/δ          s_k = Σ_{i≥k} Δl_i   (tendon past the guide)

The force that a guide takes away acts along s_k, so it always dissipates.  Its elastic part goes
into the system matrix, Σ_k C_k (∂s_k)(∂s_k)ᵀ = g_i g_j C_min(i,j) summed up: one column a tendon.
The coefficient falls with load, μ = μ₀ (T/T_ref)^-n, as that of polymers does.

Sources: capstan equation; Dahl 1968; load exponent 0.1-0.3: Bowden & Tabor 1964.
"""

import numpy as np

from spirob.emulator.physics.compiled import HINGES, SIDES, compiled

REFERENCE_LOAD = 10.0  # T_ref [N]
LEAST_LOAD = 0.5  # [N]; below it the coefficient no longer rises
NUMBERS = {
    "guide_friction": (SIDES, HINGES),  # μ₀ [-]
    "guide_load_exponent": (),  # n [-]
    "guide_slip_distance": (),  # δ [m]
}
STATE = {"asperity": (SIDES, HINGES)}  # z [-]
SCRATCH = {
    "share": (SIDES, HINGES),  # tension across each hinge over that at the winch [-]
    "stick": (SIDES, HINGES),  # Σ_{j≤i} C_j [N·s/m]
    "past": (SIDES, HINGES),  # ṡ [m/s]
}


@compiled
def guide_friction(p, s, w, h):
    """Tension shares and the elastic part of the friction."""
    for m in range(SIDES):
        past = 0.0
        for k in range(HINGES):
            i = HINGES - 1 - k
            past += w.lever[m, i] * w.q_rate[i]
            w.past[m, i] = past
        load = max(s.tension[m], LEAST_LOAD) / REFERENCE_LOAD
        load_factor = load**-p.guide_load_exponent if p.guide_load_exponent > 0.0 else 1.0
        share = 1.0
        stick = 0.0
        wrap_before = 0.0
        for i in range(HINGES):
            wrap = abs(w.q[i])
            loss = p.guide_friction[m, i] * load_factor * 0.5 * (wrap + wrap_before)
            wrap_before = wrap
            z = s.asperity[m, i]
            if loss > 0.0:
                share *= np.exp(-loss * z)
            w.share[m, i] = share
            grip = s.tension[m] * share * loss / p.guide_slip_distance
            side = 1.0 if w.past[m, i] >= 0.0 else -1.0
            stick += h * grip * max(1.0 - z * side, 0.0)
            w.stick[m, i] = stick


@compiled
def add_tendons(w, h):
    """Generalised pull of each tendon, and the columns of its friction in the system matrix."""
    for m in range(SIDES):
        pull_next, lever_next, stick_next = 0.0, 0.0, 0.0
        for k in range(HINGES):
            i = HINGES - 1 - k
            lever, stick = w.lever[m, i], w.stick[m, i]
            pull = lever * w.share[m, i]
            w.pull[m, i] = pull - pull_next
            pull_next = pull
            w.u[i, 2 + m] = h * (lever - lever_next)
            w.v[i, 2 + m] = lever * stick - lever_next * stick_next
            w.diagonal[i] += h * (
                (lever * lever - 2.0 * lever * lever_next) * stick
                + lever_next * lever_next * stick_next
            )
            lever_next, stick_next = lever, stick
        drag = 0.0
        before = 0.0
        for i in range(HINGES):
            drag += (w.stick[m, i] - before) * w.past[m, i]
            before = w.stick[m, i]
            w.moment[i] -= w.lever[m, i] * drag


@compiled
def rub(p, s, w, h):
    """Move the asperities with the slip of the step (implicit Euler: |z| never exceeds 1)."""
    for m in range(SIDES):
        past = 0.0
        for k in range(HINGES):
            i = HINGES - 1 - k
            past += w.lever[m, i] * w.q_rate[i]
            if p.guide_friction[m, i] > 0.0:
                slip = past * h / p.guide_slip_distance
                s.asperity[m, i] = (s.asperity[m, i] + slip) / (1.0 + abs(slip))
