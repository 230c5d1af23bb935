"""Tendons: the line they are made of, how tight they are, and what the guides take.

The line answers a stretch e and creeps by x_m:

    T(e) = K [e - (1-κ) ε₀ (1 - exp(-e/ε₀))]   e > 0       T = κ K e   e ≤ 0 (slack, for the solver)
    ẋ_m = (C_m T - x_m)/τ_m                                 e = x - Δl - Σ x_m

A braid first straightens its strands over a toe ε₀, during which it has only the share κ of its
stiffness; without a toe it is a plain spring.  Under load it grows by C_m T after each time τ_m.
Sources: toe region of braided and polymer ropes (exponential form of Fung 1967); creep of UHMWPE
line in data sheets, a Prony series of compliances.

The length across each hinge follows from the guides.  Between the guide before hinge i (at p from
the hinge) and the guide after it (at c), β apart in the straight arm, the left tendon spans

    ℓ_i² = |p|² + |c|² - 2|p||c| cos(β - q_i),      right: β + q_i
    g_i  = -∂ℓ_i/∂q_i,      shortening Δl = Σ_i ℓ_i(0) - ℓ_i(q_i)

A tendon is a one-sided spring with a damper between its winch and the arm, e = x - Δl less what
the line has crept,

    T = max(0, T(e) + c ė)                     T(e) = K e in a plain line

taken at the end of the step: ė depends on both tensions through the arm and on its own through
its winch, which leaves two linear complementarity conditions, solved by going through the cases.

Guides rub.  A tendon that slides round a guide through the wrap angle ω_k loses tension like a rope
on a capstan.  A guide sits between two hinges and is wrapped by half of each, so its wrap is (|q_k|
+ |q_{k+1}|)/2 and all guides together have Σ|q|.  From the winch to the tip

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

from spirob.emulator.physics import HINGES, SIDES, compiled

CREEP_TERMS = 2
TOE_SHARE = 0.1  # κ
REFERENCE_LOAD = 10.0  # T_ref [N]
LEAST_LOAD = 0.5  # [N]; below it the coefficient no longer rises
NUMBERS = {
    "tendon_stiffness": (SIDES,),  # K [N/m]
    "tendon_damping": (SIDES,),  # c [N·s/m]
    "tendon_toe": (SIDES,),  # ε₀ [m]
    "tendon_creep": (SIDES, CREEP_TERMS),  # C [m/N]
    "tendon_creep_time": (CREEP_TERMS,),  # τ [s]
    "guide_product": (SIDES, HINGES),  # |p||c| [m²]
    "guide_difference": (SIDES, HINGES),  # (|p| - |c|)² [m²]
    "guide_span": (SIDES, HINGES),  # ℓ(0) [m]
    "guide_sine": (SIDES, HINGES),  # sin β/2
    "guide_cosine": (SIDES, HINGES),  # cos β/2
    "guide_friction": (SIDES, HINGES),  # μ₀ [-]
    "guide_load_exponent": (),  # n [-]
    "guide_slip_distance": (),  # δ [m]
}
STATE = {
    "tendon_growth": (SIDES, CREEP_TERMS),  # x_m [m]
    "wound": (SIDES,),  # x, tendon wound in since the arm was straight [m]
    "tension": (SIDES,),  # at the winch [N]
    "asperity": (SIDES, HINGES),  # z [-]
}
SCRATCH = {
    "shortening": (SIDES,),  # Δl [m]
    "lever": (SIDES, HINGES),  # g [m]
    "pull": (SIDES, HINGES),  # generalised force on φ of one newton at the winch [m]
    "answer": (SIDES, HINGES),  # H⁻¹ pull
    "share": (SIDES, HINGES),  # tension across each hinge over that at the winch [-]
    "stick": (SIDES, HINGES),  # Σ_{j≤i} C_j [N·s/m]
    "past": (SIDES, HINGES),  # ṡ [m/s]
}


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


@compiled
def routing(p, s, w, h):
    """Shortening and lever arms; a nearly closed gap stiffens its hinge under tension.

    Written in half angles, which keep all digits when the gap closes.
    """
    w.shortening[0], w.shortening[1] = 0.0, 0.0
    for i in range(HINGES):
        half_q = 0.5 * w.q[i]
        sine_q, cosine_q = np.sin(half_q), np.cos(half_q)
        for m in range(SIDES):
            sign = 1.0 if m == 0 else -1.0
            sine = p.guide_sine[m, i] * cosine_q - sign * p.guide_cosine[m, i] * sine_q
            cosine = p.guide_cosine[m, i] * cosine_q + sign * p.guide_sine[m, i] * sine_q
            product = p.guide_product[m, i]
            length = np.sqrt(p.guide_difference[m, i] + 4.0 * product * sine * sine)
            w.shortening[m] += p.guide_span[m, i] - length
            lever = 2.0 * product * sine * cosine / length
            w.lever[m, i] = sign * lever
            bend = (product * (1.0 - 2.0 * sine * sine) - lever * lever) / length
            if bend > 0.0:
                w.implicit[i] += h * h * s.tension[m] * bend
                w.moment[i] -= h * s.tension[m] * bend * w.q_rate[i]


@compiled
def complementarity(a11, a12, a21, a22, b1, b2):
    """t ≥ 0, a t - b ≥ 0, one of the two zero for each tendon."""
    det = a11 * a22 - a12 * a21
    t1 = (b1 * a22 - a12 * b2) / det
    t2 = (a11 * b2 - a21 * b1) / det
    if t1 >= 0.0 and t2 >= 0.0:
        return t1, t2
    alone = b1 / a11
    if alone > 0.0 and a21 * alone >= b2:
        return alone, 0.0
    alone = b2 / a22
    if alone > 0.0 and a12 * alone >= b1:
        return 0.0, alone
    return 0.0, 0.0


@compiled
def tighten(p, s, w, h):
    """Tensions at the end of the step, from the free rates of arm (w.force) and winches."""
    a = np.empty((SIDES, SIDES))
    b = np.empty(SIDES)
    for m in range(SIDES):
        force, slope = elastic(p, m, s.wound[m] - w.shortening[m] - grown(s, m))
        stiff = h * slope + p.tendon_damping[m]
        free = 0.0
        for n in range(SIDES):
            a[m, n] = 0.0
        before = 0.0
        before_answer = np.zeros(SIDES)
        for i in range(HINGES):
            free += w.lever[m, i] * (w.force[i] - before)
            before = w.force[i]
            for n in range(SIDES):
                a[m, n] += h * w.lever[m, i] * (w.answer[n, i] - before_answer[n])
                before_answer[n] = w.answer[n, i]
        a[m, m] = max(a[m, m], 0.0) + 1.0 / stiff + w.winch_yield[m]
        b[m] = force / stiff + w.winch_free[m] - free
    left, right = complementarity(a[0, 0], a[0, 1], a[1, 0], a[1, 1], b[0], b[1])
    s.tension[0], s.tension[1] = left, right


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
