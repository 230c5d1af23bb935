"""The drive: its current loop, the winding it feeds, and how warm that gets.

    L i̇ + R i = V - k_e ω          |V| ≤ 24 V

The loop runs at 20 kHz or faster with pole cancellation, K_p = 2πf L, K_i = 2πf R, and adds the
back-EMF it expects; the winding is stepped exactly for a constant voltage.  The loop regulates
what its sensor *says*, gain·i + offset, so a wrong sensor turns into a wrong current.

    C Θ̇ = R i² - (Θ - Θ₀)/R_th      R = R₀ (1 + α_R (Θ - Θ₀))    k_t = k_t0 (1 - α_B (Θ - Θ₀))
"""

import numpy as np

from spirob.emulator.physics.compiled import SIDES, compiled

NUMBERS = {
    "resistance": (SIDES,),  # R₀ [Ω]
    "inductance": (SIDES,),  # L [H]
    "torque_constant": (SIDES,),  # k_t = k_e [N·m/A]
    "supply": (),  # [V]
    "bandwidth": (),  # f [Hz]
    "electric_steps": (),  # of the current loop in one step of the mechanics
    "sensor_gain": (SIDES,),  # [-]
    "sensor_offset": (SIDES,),  # [A]
    "sensor_drift": (SIDES,),  # offset gained in the long run [A]
    "sensor_drift_time": (),  # [s]
    "ambient": (),  # Θ₀ [°C]
    "heat_resistance": (SIDES,),  # R_th [K/W]
    "heat_capacity": (SIDES,),  # C [J/K]
    "resistance_heating": (),  # α_R [1/K]
    "magnet_heating": (),  # α_B [1/K]
}
STATE = {
    "current": (SIDES,),  # in the winding [A]
    "integral": (SIDES,),  # of the current loop [V]
    "warmth": (SIDES,),  # Θ - Θ₀ [K]
    "time": (),  # since the trial began [s]
}
SCRATCH = {
    "target": (SIDES,),  # commanded current [A]
    "mean_current": (SIDES,),  # over the step [A]
}


@compiled
def sensed(p, s, m):
    """What the current sensor says, noise apart [A]."""
    drift = p.sensor_drift[m] * (1.0 - np.exp(-s.time / p.sensor_drift_time))
    return p.sensor_gain[m] * s.current[m] + p.sensor_offset[m] + drift


@compiled
def torque_constant(p, s, m):
    """k_t of the magnets as warm as they are [N·m/A]."""
    return p.torque_constant[m] * (1.0 - p.magnet_heating * s.warmth[m])


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
        heat = resistance * w.mean_current[m] ** 2 - s.warmth[m] / p.heat_resistance[m]
        s.warmth[m] += h * heat / p.heat_capacity[m]
