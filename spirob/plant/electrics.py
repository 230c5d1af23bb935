"""Motor electrics (paper eq. 1) under the drive's feedforward and feedback (eqs. ff, fb).

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
"""

import math


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
