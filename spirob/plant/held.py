"""The winding (paper eq. 1) under the voltage that the host holds for a cycle.

    i(t + T) = i(t) E + (u - k_e ω - d)/R (1 - E),    E = exp(-R T / L)

exact for held u and ω.  A new voltage comes in the middle of a step: `late` is when.
"""

import math


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
