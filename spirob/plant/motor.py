"""Motor electrics (paper eq. 1), and motor and winch (eqs. 4-8) at a stiff one-sided tendon.

L di/dt = u - R i - k_e ω - d
    u = L di_cmd/dt + R i_cmd + c_e k_e ω + K_p e + K_i ∫e dt,    e = i_cmd - y

The gains place both poles of (L + K_d) ë + (R + K_p) ė + K_i e = ḋ at the bandwidth ω_c, with
K_d = 0:  K_p = 2 ω_c L - R,  K_i = ω_c² L.  The drive samples at its own rate; between samples u
and ω are held and the R-L circuit is solved exactly,

    i(t + T) = i(t) E + (u - k_e ω - d)/R (1 - E),    E = exp(-R T / L),

because at 1 kHz T R/L is about 2, where explicit Euler is wrong.  The loop is closed on what
the sensor says of the motor current, y = i*, or y = i* + ε where the sensor is wrong by ε: then the
reading follows the command and the current does not.  The current i** reconstructed from the arm is
an output.

Under a voltage that the host holds for a cycle the winding (paper eq. 1) follows

    i(t + T) = i(t) E + (u - k_e ω - d)/R (1 - E),    E = exp(-R T / L)

exact for held u and ω.  A new voltage comes in the middle of a step: `late` is when.

Motor and winch (paper eqs. 4-8) are coupled to the arm through a stiff one-sided tendon.  The
literal cycle, which feeds the previous cycle's acceleration back through J_eq/r² (kilograms) into
an arm that weighs grams at the tendon, diverges within milliseconds.  Here the rotor keeps a state
of its own and the tension is found linearly implicitly from both ends of the tendon:

    m ẇ = τ/r - (b + b_f) w - F          m = J_eq/r², b = b_eq/r², τ = η G k_t i* + G τ_effects
    dv/dt = a + A F                      the arm: A = J M⁻¹ Jᵀ, a = all that is not this tension
    F = max(0, k e + c ė),  e = x - Δl   with ė at the end of the step

`a` is observed from the arm's last step, so springs, end stops and contact are in it.  The two
tensions are solved together: each tendon pulls the arm out of the other's way, so solving them one
by one lets them fight from step to step (15 % error in tension after a step of current).  Taking e
at the start and ė at the end of the step keeps the slow bounce of the rotor on its tendon free of
numerical damping; where c < h k the step cannot resolve a tendon so little damped, and h k is used.
"""

import math

import numpy as np


def own(mean, difference, m):
    """The number of one motor, 0 the left, 1 the right, of their mean and relative difference."""
    return mean * (1.0 + (1.0 - 2.0 * m) * difference)


def current_loop_gains(resistance, inductance, bandwidth):
    """K_p [V/A] and K_i [V/(A·s)] for both poles at `bandwidth` [Hz]; K_p is never negative."""
    omega = 2.0 * math.pi * bandwidth
    return max(0.0, 2.0 * omega * inductance - resistance), omega * omega * inductance


def drive_current(
    current,
    integral,
    command,
    command_rate,
    misread,
    emf,
    disturbance,
    steps,
    period,
    resistance,
    inductance,
    gain_p,
    gain_i,
    emf_compensation,
    voltage_limit,
):
    """Run the drive for `steps` samples; returns (current, integral, mean current) [A, V, A].

    misread [A] (ε), emf, disturbance [V] are held; the integral stops while the voltage is at its
    limit and the error would drive it further.
    """
    decay = math.exp(-resistance * period / inductance)
    total = 0.0
    for _ in range(steps):
        error = command - (current + misread)
        feedforward = inductance * command_rate + resistance * command + emf_compensation * emf
        wanted = feedforward + gain_p * error + integral
        voltage = min(max(wanted, -voltage_limit), voltage_limit)
        if voltage == wanted or wanted * error < 0.0:
            integral += gain_i * error * period
        final = (voltage - emf - disturbance) / resistance
        # mean of the exponential over the period, exact
        shape = (1.0 - decay) * inductance / (resistance * period)
        total += final + (current - final) * shape
        current = final + (current - final) * decay
    return current, integral, total / steps


def held_current(
    current,
    before,
    after,
    late,
    period,
    emf,
    disturbance,
    resistance,
    inductance,
    voltage_limit,
):
    """Current at the end of a step and its mean over it [A].

    before, after  voltages until and from `late` [s] into the step of `period` [s], each within
                   ± voltage_limit [V];  emf, disturbance  [V], held
    """
    total = 0.0
    for part in range(2):
        voltage = before if part == 0 else after
        span = late if part == 0 else period - late
        if span <= 0.0:
            continue
        voltage = min(max(voltage, -voltage_limit), voltage_limit)
        final = (voltage - emf - disturbance) / resistance
        decay = math.exp(-resistance * span / inductance)
        total += final * span + (current - final) * (1.0 - decay) * inductance / resistance
        current = final + (current - final) * decay
    return current, total / period


def counted(value, count):
    """A value as a frame holds it, a whole number of counts; as it is where a count is nothing."""
    return count * np.rint(value / count) if count > 0.0 else value


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
