"""Play between the motor and its load."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class Backlash(Effect):
    """τ = J_l·(ω' + ω/T - p): of the torque that a rigid load would need, the flanks pass J_l·p.

    The load is behind the motor by φ, φ'' = ω' + ω_l/T - p.  Within the play b nothing is passed,
    p = 0, and it coasts; beyond, the teeth push as a damped spring, p = Ω²·(φ ∓ b/2) + 2·D·Ω·φ'
    with Ω = 2π·f, D = 0.3.  Steps are exact for a constant acceleration.
    """

    port = "motor.torque"
    reads = {"speed": "motor.speed"}
    state = {"behind": 0.0, "rate": 0.0, "last": 0.0, "before": 0.0, "seen": 0.0}
    neutral = {"load_inertia": 0.0}
    title = "backlash between motor and load"
    signature = "A moment of ease when the effort changes sides, then a blow."
    explanation = (
        "Teeth leave a gap: when the load changes sides the motor runs through it alone, and "
        "catches the load at the other flank."
    )
    tell_apart = {
        "gear_compliance": "small and large motions: a spring's share is the same, play's is not",
        "presliding_friction": "a steady load on one side: play disappears, friction does not",
        "coulomb_friction": "a steady load on one side: play disappears, friction does not",
    }
    needs = "an effort that changes sides, with a load that can be accelerated"
    references = ("Nordin, Gutman, Automatica 38 (2002)",)

    load_inertia: float = bounded(4e-5, 0.0, 4e-3, "N·m·s²/rad", "J_l", "inertia behind the play")
    play: float = bounded(0.05, 1e-4, 10.0, "rad", "b", "way from flank to flank", log=True)
    coasting: float = bounded(
        0.3, 0.01, 10.0, "s", "T", "time in which the loose load comes to rest", log=True
    )

    frequency: float = bounded(
        30.0, 8.0, 120.0, "Hz", "f", "at which the load swings on the teeth", log=True
    )

    @staticmethod
    def kernel(
        speed,
        behind,
        rate,
        last,
        before,
        seen,
        load_inertia,
        play,
        coasting,
        frequency,
        dt,
    ):
        """Torque on the motor [N·m]; next way behind [rad], its rate, and two speeds [rad/s]."""
        half = 0.5 * play
        if seen == 0.0:
            return 0.0, math.copysign(half, speed), 0.0, speed, speed, 1.0
        own, ratio = 2.0 * math.pi * frequency, 0.3
        beat, decay = own * math.sqrt(1.0 - ratio * ratio), ratio * own
        mean = (speed - last) / dt
        push = mean + (last - rate) / max(coasting, dt)  # it rests within a step at the soonest
        if abs(behind) >= half:
            flank = math.copysign(half, behind)
            level = push / (own * own)
            x, fall = behind - flank - level, math.exp(-decay * dt)
            c, s = fall * math.cos(beat * dt), fall * math.sin(beat * dt) / beat
            behind = flank + level + x * (c + decay * s) + rate * s
            rate = rate * (c - decay * s) - x * own * own * s
        else:
            behind += dt * (rate + 0.5 * push * dt)
            rate += push * dt
        passed = 0.0
        if abs(behind) >= half:
            x = behind - math.copysign(half, behind)
            passed = own * own * x + 2.0 * decay * rate
        end = (3.0 * speed - 4.0 * last + before) / (2.0 * dt) if seen > 1.0 else mean
        torque = load_inertia * (end + speed / coasting - passed)
        return torque, behind, rate, speed, last, 2.0
