"""The drive: the winding under a voltage, the loop that holds a current, and what it reports.

The winding of a motor in voltage mode holds what it is told until the next is there,

    L i̇ + R i = V - k_e ω          |V| ≤ supply

solved exactly for a held voltage.  What the host sends comes at some moment of a cycle: the step
that it falls into is divided there.

A drive that holds a current has a loop before the same winding, and the winding warms up.

    L i̇ + R i = V - k_e ω          |V| ≤ 24 V

The loop runs at 20 kHz or faster with pole cancellation, K_p = 2πf L, K_i = 2πf R, and adds the
back-EMF it expects; the winding is stepped exactly for a constant voltage.  The loop regulates
what its sensor *says*, gain·i + offset, so a wrong sensor turns into a wrong current.  What it
aims at is the command less a dead band with a soft knee, i = c - δ tanh(c/δ), δ for each sign of c.

    C ϑ̇ = R i² - ϑ/R_th (1 + (aϑ)³)      R = R₀ (1 + α_R ϑ)      ϑ above the room

What heat does to the magnets stands in motor.py; a is the heat that radiation carries off.  A
drive that is told a voltage has no loop of its own.

Once a cycle a drive says of itself, in counts:

angle        ⌊8192 θ_e/2π⌋ mod 8192,  θ_e = θ + Σ a_n sin(nθ + ψ_n)  off-centre encoder (n = 1, 2)
speed        rounded [rpm], of θ_e
current      filtered (sensed + noise) in counts of 20/16384 A, rounded; two equal poles of time τ
temperature  of the winding, rounded [°C]

All four leave the drive `latency` cycles after they were measured; until then it repeats its first.
"""

import numpy as np

from spirob.emulator.physics import SIDES, compiled
from spirob.emulator.physics.motor import torque_constant

COMING = 2  # voltages that may come within a cycle
AMPERE_PER_COUNT = 20.0 / 16384.0
COUNTS_PER_TURN = 8192
FIELDS = 4  # angle, speed, current, temperature
DEPTH = 64  # cycles that a frame may wait
NUMBERS = {
    "by_voltage": (),  # 1 where a command is a voltage, 0 where it is a current
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
    "current_noise": (),  # rms [A]
    "encoder_error": (SIDES, 2),  # a [rad]
    "encoder_phase": (SIDES, 2),  # ψ [rad]
    "filter_time": (SIDES,),  # τ [s]
    "latency": (SIDES,),  # whole cycles, less than DEPTH
}
STATE = {
    "volts": (SIDES,),  # told last [V]
    "current": (SIDES,),  # in the winding [A]
    "integral": (SIDES,),  # of the current loop [V]
    "time": (),  # since the trial began [s]
    "filtered": (SIDES, 2),  # the current after each pole [A]
    "waiting": (SIDES, FIELDS, DEPTH),  # counts that have been measured
    "measured": (),  # how many cycles so far
}
SCRATCH = {
    "elapsed": (),  # of the cycle, when the step begins [s]
    "coming": (),  # how many voltages come in this cycle
    "taken": (),  # how many of them have come
    "comes_at": (COMING,),  # [s] of the cycle
    "coming_volts": (COMING, SIDES),  # [V]
    "target": (SIDES,),  # current to be held [A]
    "mean_current": (SIDES,),  # over the step [A]
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


@compiled
def clipped(value, low, high):
    """The nearest whole number within the field of the frame."""
    return int(min(max(np.round(value), low), high))


@compiled
def encoder(p, s, m):
    """Angle [rad] and speed [rad/s] as the encoder has them."""
    angle, speed = s.rotor_angle[m], s.rotor_speed[m]
    for n in range(2):
        if p.encoder_error[m, n] > 0.0:
            phase = (n + 1.0) * s.rotor_angle[m] + p.encoder_phase[m, n]
            angle += p.encoder_error[m, n] * np.sin(phase)
            speed += p.encoder_error[m, n] * (n + 1.0) * s.rotor_speed[m] * np.cos(phase)
    return angle, speed


@compiled
def reported(p, s, m, current, period):
    """The current after the drive's filter [A]."""
    if p.filter_time[m] <= 0.0:
        return current
    follow = 1.0 - np.exp(-period / p.filter_time[m])
    s.filtered[m, 0] += follow * (current - s.filtered[m, 0])
    s.filtered[m, 1] += follow * (s.filtered[m, 0] - s.filtered[m, 1])
    return s.filtered[m, 1]


@compiled
def measure(p, s, m, noise, period, counts):
    """Angle, speed, current and temperature of one drive as they are now."""
    angle, speed = encoder(p, s, m)
    turns = angle / (2.0 * np.pi)
    turns -= np.floor(turns)
    counts[m, 0] = int(np.floor(turns * COUNTS_PER_TURN)) % COUNTS_PER_TURN
    counts[m, 1] = clipped(speed * 60.0 / (2.0 * np.pi), -32768.0, 32767.0)
    current = reported(p, s, m, sensed(p, s, m) + p.current_noise * noise, period)
    counts[m, 2] = clipped(current / AMPERE_PER_COUNT, -32768.0, 32767.0)
    counts[m, 3] = clipped(p.ambient + s.warmth[m], 0.0, 255.0)


@compiled
def feedback(p, s, noise, period, counts):
    """Write what each drive says at the end of a cycle into counts (2, 4)."""
    now = int(s.measured)
    for m in range(SIDES):
        measure(p, s, m, noise[m], period, counts)
        if p.latency[m] > 0.0:
            then = max(now - int(p.latency[m]), 0) % DEPTH
            for field in range(FIELDS):
                s.waiting[m, field, now % DEPTH] = counts[m, field]
                counts[m, field] = int(s.waiting[m, field, then])
    s.measured = now + 1.0
