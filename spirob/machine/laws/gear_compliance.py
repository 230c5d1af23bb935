"""A shaft or gear that winds up between the motor and its load."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class GearCompliance(Effect):
    """τ = J_l·φ'', φ'' + 2·D·Ω·φ' + Ω²·φ = ω', Ω = 2π·f: the load stays behind the motor by φ.

    A rigid shaft would have the motor move J·ω'; of that the part J_l follows the load's own
    acceleration, ω' - φ'', instead.  Each step is exact for a speed that is linear in time; the
    acceleration at its end is the slope of the parabola through the last three speeds.  It begins
    with the twist of its first acceleration, and what it swings about that.
    """

    port = "motor.torque"
    reads = {"speed": "motor.speed"}
    free = ("twist", "rate")
    state = {"twist": 0.0, "rate": 0.0, "last": 0.0, "before": 0.0, "seen": 0.0}
    neutral = {"load_inertia": 0.0}
    title = "elastic shaft or gear between motor and load"
    signature = "Effort that leads or trails the acceleration, more so the faster it changes."
    explanation = (
        "Shafts, belts and gears twist under load, so the load swings on them: below its own "
        "frequency it amplifies the motion, above it the motor moves alone."
    )
    tell_apart = {
        "current_lag": "twice the inertia of the load: the frequency falls, a lag stays",
        "backlash": "small and large motions: a spring's share is the same, play's is not",
        "presliding_friction": "faster reversals over the same way: friction does not change",
    }
    needs = "changes of speed about as fast as the load can swing"
    references = ("Spong, ASME J. Dynamic Systems 109 (1987)",)

    load_inertia: float = bounded(4e-5, 0.0, 4e-3, "N·m·s²/rad", "J_l", "inertia behind the spring")
    frequency: float = bounded(
        8.0, 1.0, 60.0, "Hz", "f", "at which the load swings while the motor is held", log=True
    )
    damping: float = bounded(0.1, 0.01, 0.9, "1", "D", "damping ratio of that", log=True)

    @staticmethod
    def kernel(speed, twist, rate, last, before, seen, load_inertia, frequency, damping, dt):
        """Torque on the motor [N·m]; next twist [rad], its rate, and two speeds [rad/s]."""
        own = 2.0 * math.pi * frequency
        beat, decay = own * math.sqrt(1.0 - damping * damping), damping * own
        if seen == 0.0:
            swung = -load_inertia * (2.0 * decay * rate + own * own * twist)
            return swung, twist, rate, speed, speed, 1.0
        mean = (speed - last) / dt
        level = mean / (own * own)
        twist = twist + level if seen == 1.0 else twist
        x = twist - level
        fall = math.exp(-decay * dt)
        c, s = fall * math.cos(beat * dt), fall * math.sin(beat * dt) / beat
        twist = level + x * (c + decay * s) + rate * s
        rate = rate * (c - decay * s) - x * own * own * s
        end = (3.0 * speed - 4.0 * last + before) / (2.0 * dt) if seen > 1.0 else mean
        torque = load_inertia * (end - 2.0 * decay * rate - own * own * twist)
        return torque, twist, rate, speed, last, 2.0
