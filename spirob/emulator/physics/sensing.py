"""What a drive says of itself once a cycle, in counts, perhaps late.

angle        ⌊8192 θ_e/2π⌋ mod 8192,  θ_e = θ + Σ a_n sin(nθ + ψ_n)  off-centre encoder (n = 1, 2)
speed        rounded [rpm], of θ_e
current      filtered (sensed + noise) in counts of 20/16384 A, rounded; two equal poles of time τ
temperature  of the winding, rounded [°C]

All four leave the drive `latency` cycles after they were measured; until then it repeats its first.
"""

import numpy as np

from spirob.emulator.physics.compiled import SIDES, compiled
from spirob.emulator.physics.drive import sensed

AMPERE_PER_COUNT = 20.0 / 16384.0
COUNTS_PER_TURN = 8192
FIELDS = 4  # angle, speed, current, temperature
DEPTH = 64  # cycles that a frame may wait
NUMBERS = {
    "current_noise": (),  # rms [A]
    "encoder_error": (SIDES, 2),  # a [rad]
    "encoder_phase": (SIDES, 2),  # ψ [rad]
    "filter_time": (SIDES,),  # τ [s]
    "latency": (SIDES,),  # whole cycles, less than DEPTH
}
STATE = {
    "filtered": (SIDES, 2),  # the current after each pole [A]
    "waiting": (SIDES, FIELDS, DEPTH),  # counts that have been measured
    "measured": (),  # how many cycles so far
}
SCRATCH: dict[str, tuple[int, ...]] = {}


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
