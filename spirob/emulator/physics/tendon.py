"""Tendons: their length across each hinge, and how tight they are.

Between the guide before hinge i (at p from the hinge) and the guide after it (at c), β apart in
the straight arm, the left tendon spans

    ℓ_i² = |p|² + |c|² - 2|p||c| cos(β - q_i),      right: β + q_i
    g_i  = -∂ℓ_i/∂q_i,      shortening Δl = Σ_i ℓ_i(0) - ℓ_i(q_i)

A tendon is a one-sided spring with a damper between its winch and the arm, e = x - Δl less what
the line has crept,

    T = max(0, T(e) + c ė)                     T(e) = K e in a plain line, see line.py

taken at the end of the step: ė depends on both tensions through the arm and on its own through
its winch, which leaves two linear complementarity conditions, solved by going through the cases.
"""

import numpy as np

from spirob.emulator.physics.compiled import HINGES, SIDES, compiled
from spirob.emulator.physics.line import elastic, grown

NUMBERS = {
    "guide_product": (SIDES, HINGES),  # |p||c| [m²]
    "guide_difference": (SIDES, HINGES),  # (|p| - |c|)² [m²]
    "guide_span": (SIDES, HINGES),  # ℓ(0) [m]
    "guide_sine": (SIDES, HINGES),  # sin β/2
    "guide_cosine": (SIDES, HINGES),  # cos β/2
}
STATE = {
    "wound": (SIDES,),  # x, tendon wound in since the arm was straight [m]
    "tension": (SIDES,),  # at the winch [N]
}
SCRATCH = {
    "shortening": (SIDES,),  # Δl [m]
    "lever": (SIDES, HINGES),  # g [m]
    "pull": (SIDES, HINGES),  # generalised force on φ of one newton at the winch [m]
    "answer": (SIDES, HINGES),  # H⁻¹ pull
}


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
