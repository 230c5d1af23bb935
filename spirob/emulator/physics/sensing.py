"""What a drive says of itself once a cycle, in counts.

angle        ⌊8192 θ/2π⌋ mod 8192          speed  rounded [rpm]
current      (sensed + noise) in counts of 20/16384 A, rounded
temperature  of the winding, rounded [°C]
"""

import numpy as np

from spirob.emulator.physics.compiled import SIDES, compiled
from spirob.emulator.physics.drive import sensed

AMPERE_PER_COUNT = 20.0 / 16384.0
COUNTS_PER_TURN = 8192
NUMBERS = {"current_noise": ()}  # rms [A]
STATE: dict[str, tuple[int, ...]] = {}
SCRATCH: dict[str, tuple[int, ...]] = {}


@compiled
def clipped(value, low, high):
    """The nearest whole number within the field of the frame."""
    return int(min(max(np.round(value), low), high))


@compiled
def feedback(p, s, noise, counts):
    """Write angle, speed, current and temperature of each drive into counts (2, 4)."""
    for m in range(SIDES):
        turns = s.rotor_angle[m] / (2.0 * np.pi)
        turns -= np.floor(turns)
        counts[m, 0] = int(np.floor(turns * COUNTS_PER_TURN)) % COUNTS_PER_TURN
        rpm = s.rotor_speed[m] * 60.0 / (2.0 * np.pi)
        counts[m, 1] = clipped(rpm, -32768.0, 32767.0)
        current = sensed(p, s, m) + p.current_noise * noise[m]
        counts[m, 2] = clipped(current / AMPERE_PER_COUNT, -32768.0, 32767.0)
        counts[m, 3] = clipped(p.ambient + s.warmth[m], 0.0, 255.0)
