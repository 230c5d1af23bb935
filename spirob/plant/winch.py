"""Motor and winch (paper eqs. 4-8) coupled to the arm through a stiff one-sided tendon.

The literal cycle, which feeds the previous cycle's acceleration back through J_eq/r² (kilograms)
into an arm that weighs grams at the tendon, diverges within milliseconds.  Here the rotor keeps a
state of its own and the tension is found linearly implicitly from both ends of the tendon:

    m ẇ = τ/r - (b + b_f) w - F          m = J_eq/r², b = b_eq/r², τ = η G k_t i* + G τ_effects
    dv/dt = a + A F                      the arm: A = J M⁻¹ Jᵀ, a = all that is not this tension
    F = max(0, k e + c ė),  e = x - Δl   with ė at the end of the step

`a` is observed from the arm's last step, so springs, end stops and contact are in it.  The two
tensions are solved together: each tendon pulls the arm out of the other's way, so solving them one
by one lets them fight from step to step (15 % error in tension after a step of current).  Taking e
at the start and ė at the end of the step keeps the slow bounce of the rotor on its tendon free of
numerical damping; where c < h k the step cannot resolve a tendon so little damped, and h k is used.
"""


def free_rate(rate, force, inertia, damping, step):
    """Rate of the winch after a step without the tendon [m/s], damping implicit.

    force [N] at the drum's surface, inertia J_eq/r² [kg], damping [N·s/m].
    """
    return (rate + step * force / inertia) / (1.0 + step * damping / inertia)


def demanded_tension(stretch, rate_free, arm_rate, arm_acceleration, k, c, step):
    """Tension [N] at the end of the step if neither rotor nor arm gave way to it.

    stretch    e = x - Δl [m] at the start of the step;  k [N/m];  c [N·s/m], at least h k
    rate_free  winch rate at the end of the step without tension [m/s]
    arm_rate   dΔl/dt [m/s];  arm_acceleration  a [m/s²]
    """
    closing = rate_free - (arm_rate + step * arm_acceleration)
    return k * stretch + c * closing


def one_sided_tensions(demand_1, demand_2, give_11, give_12, give_21, give_22):
    """Tensions F ≥ 0 [N] of both tendons with F = demand - (give - 1) F wherever F > 0.

    give = 1 + h c (1/(m + h b) + A): what rotor and arm yield to a tension; the tendons
    meet in the arm through the off-diagonal of A, which is nearly as large as its diagonal.  Of
    the four cases (taut or slack each) exactly one satisfies its own inequalities.
    """
    determinant = give_11 * give_22 - give_12 * give_21
    both_1 = (demand_1 * give_22 - demand_2 * give_12) / determinant
    both_2 = (demand_2 * give_11 - demand_1 * give_21) / determinant
    if both_1 >= 0.0 and both_2 >= 0.0:
        return both_1, both_2
    alone_1 = max(0.0, demand_1 / give_11)
    if demand_2 - give_21 * alone_1 <= 0.0:
        return alone_1, 0.0
    return 0.0, max(0.0, demand_2 / give_22)
