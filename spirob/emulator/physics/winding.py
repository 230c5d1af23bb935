"""The winding of a motor in voltage mode: what it is told is held until the next is there.

    L i̇ + R i = V - k_e ω          |V| ≤ supply

solved exactly for a held voltage.  What the host sends comes at some moment of a cycle: the step
that it falls into is divided there.
"""

import numpy as np

from spirob.emulator.physics.compiled import SIDES, compiled

COMING = 2  # voltages that may come within a cycle
NUMBERS = {"by_voltage": ()}  # 1 where a command is a voltage, 0 where it is a current
STATE = {"volts": (SIDES,)}  # told last [V]
SCRATCH = {
    "elapsed": (),  # of the cycle, when the step begins [s]
    "coming": (),  # how many voltages come in this cycle
    "taken": (),  # how many of them have come
    "comes_at": (COMING,),  # [s] of the cycle
    "coming_volts": (COMING, SIDES),  # [V]
}


@compiled
def hold(p, s, w, m, resistance, back_emf, h):
    """Run one winding through a step; the mean current over it [A]."""
    total, passed = 0.0, 0.0
    for k in range(int(w.taken), int(w.coming) + 1):
        until = h
        if k < int(w.coming):
            until = min(max(w.comes_at[k] - w.elapsed, passed), h)
        span = until - passed
        if span > 0.0:
            voltage = min(max(s.volts[m], -p.supply), p.supply)
            settled = (voltage - back_emf) / resistance
            left = np.exp(-resistance * span / p.inductance[m])
            moved = s.current[m] - settled
            total += settled * span + moved * (1.0 - left) * p.inductance[m] / resistance
            s.current[m] = settled + moved * left
        if k == int(w.coming) or until >= h:
            break
        s.volts[m] = w.coming_volts[k, m]
        passed = until
    return total / h


@compiled
def take(w, h):
    """Count the voltages that have come within the step."""
    while w.taken < w.coming and w.comes_at[int(w.taken)] - w.elapsed < h:
        w.taken += 1.0
