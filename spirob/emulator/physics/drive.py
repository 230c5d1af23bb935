"""The drive: its current loop, the winding it feeds, and how warm that gets.

    L i̇ + R i = V - k_e ω          |V| ≤ 24 V

The loop runs at 20 kHz or faster with pole cancellation, K_p = 2πf L, K_i = 2πf R, and adds the
back-EMF it expects; the winding is stepped exactly for a constant voltage.  The loop regulates
what its sensor *says*, gain·i + offset, so a wrong sensor turns into a wrong current.  What it
aims at is the command less a dead band with a soft knee, i = c - δ tanh(c/δ), δ for each sign of c.

    C ϑ̇ = R i² - ϑ/R_th (1 + (aϑ)³)      R = R₀ (1 + α_R ϑ)      ϑ above the room

What heat does to the magnets stands in magnets.py; a is the heat that radiation carries off.  A
drive that is told a voltage has no loop of its own (winding.py).
"""

import numpy as np

from spirob.emulator.physics.compiled import SIDES, compiled
from spirob.emulator.physics.magnets import torque_constant
from spirob.emulator.physics.winding import hold, take

NUMBERS = {
    "resistance": (SIDES,),  # R₀ [Ω]
    "inductance": (SIDES,),  # L [H]
    "supply": (),  # [V]
    "bandwidth": (),  # f [Hz]
    "electric_steps": (),  # of the current loop in one step of the mechanics
    "dead_band": (SIDES, 2),  # δ for commands that wind in and that pay out [A]
    "sensor_gain": (SIDES,),  # [-]
    "sensor_offset": (SIDES,),  # [A]
    "sensor_drift": (SIDES,),  # offset gained in the long run [A]
    "sensor_drift_time": (),  # [s]
    "ambient": (),  # of the room [°C]
    "heat_resistance": (SIDES,),  # R_th [K/W]
    "heat_capacity": (SIDES,),  # C [J/K]
    "heat_escape": (),  # a [1/K]
    "resistance_heating": (),  # α_R [1/K]
}
STATE = {
    "current": (SIDES,),  # in the winding [A]
    "integral": (SIDES,),  # of the current loop [V]
    "time": (),  # since the trial began [s]
}
SCRATCH = {
    "target": (SIDES,),  # current to be held [A]
    "mean_current": (SIDES,),  # over the step [A]
}


@compiled
def sensed(p, s, m):
    """What the current sensor says, noise apart [A]."""
    drift = p.sensor_drift[m] * (1.0 - np.exp(-s.time / p.sensor_drift_time))
    return p.sensor_gain[m] * s.current[m] + p.sensor_offset[m] + drift


@compiled
def understood(p, command, m):
    """The current that the drive aims at when it is told `command` [A]."""
    band = p.dead_band[m, 0] if command >= 0.0 else p.dead_band[m, 1]
    if band <= 0.0:
        return command
    return command - band * np.tanh(command / band)


@compiled
def drive(p, s, w, h):
    """Run the current loops through one step of the mechanics."""
    count = int(p.electric_steps)
    dt = h / count
    for m in range(SIDES):
        resistance = p.resistance[m] * (1.0 + p.resistance_heating * s.warmth[m])
        decay = np.exp(-resistance * dt / p.inductance[m])
        back_emf = torque_constant(p, s, m) * s.rotor_speed[m]
        nominal = p.torque_constant[m] * s.rotor_speed[m]
        cut = 2.0 * np.pi * p.bandwidth
        total = 0.0
        if p.by_voltage > 0.0:
            w.mean_current[m] = hold(p, s, w, m, resistance, back_emf, h)
        else:
            for _ in range(count):
                error = w.target[m] - sensed(p, s, m)
                wanted = cut * p.inductance[m] * error + s.integral[m] + nominal
                voltage = min(max(wanted, -p.supply), p.supply)
                if wanted == voltage or (wanted - voltage) * error < 0.0:
                    s.integral[m] += cut * p.resistance[m] * error * dt
                settled = (voltage - back_emf) / resistance
                total += 0.5 * s.current[m]
                s.current[m] = settled + (s.current[m] - settled) * decay
                total += 0.5 * s.current[m]
            w.mean_current[m] = total / count
        lost = s.warmth[m] / p.heat_resistance[m]
        if p.heat_escape > 0.0:
            lost *= 1.0 + (p.heat_escape * s.warmth[m]) ** 3
        s.warmth[m] += h * (resistance * w.mean_current[m] ** 2 - lost) / p.heat_capacity[m]
    take(w, h)
