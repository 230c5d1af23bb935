"""Motor and winch (paper eqs. 4-8) coupled to the arm through a stiff one-sided tendon.

The literal cycle, which feeds the previous cycle's acceleration back through J_eq/r² (kilograms)
into an arm that weighs grams at the tendon, diverges within milliseconds.  Here the rotor keeps a
state of its own and the tension is found linearly implicitly from both ends of the tendon:

    m ẇ = τ/r - (b + b_f) w - F          m = J_eq/r², b = b_eq/r², τ = η G k_t i* + G τ_effects
    dv/dt = a + A F                      the arm: A = J M⁻¹ Jᵀ, a = all that is not this tension
    F = max(0, k e + c ė),  e = x - Δl   both taken at the end of the step

`a` is observed from the arm's last step, so springs, end stops and contact are in it.
"""


def free_rate(rate, force, inertia, damping, step):
    """Rate of the winch after a step without the tendon [m/s], damping implicit.

    force [N] at the drum's surface, inertia J_eq/r² [kg], damping [N·s/m].
    """
    return (rate + step * force / inertia) / (1.0 + step * damping / inertia)


def implicit_tension(
    stretch, rate_free, arm_rate, arm_acceleration, inertia, damping, mobility, k, c, step
):
    """Tension [N] at the end of the step; never negative (a tendon does not push).

    stretch           e = x - Δl [m] at the start of the step
    rate_free         winch rate at the end of the step without tension [m/s]
    arm_rate          dΔl/dt [m/s];  arm_acceleration  a [m/s²]
    mobility          A = J M⁻¹ Jᵀ [1/kg]
    """
    closing = rate_free - (arm_rate + step * arm_acceleration)
    stiff = step * k + c
    force = k * stretch + stiff * closing
    give = 1.0 + step * stiff * (1.0 / (inertia + step * damping) + mobility)
    return max(0.0, force / give)
