"""Dry friction that winds up like a spring before the shaft breaks away."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class PreslidingFriction(Effect):
    """τ = -T_p·z, dz/dt = (ω - |ω|·z)/δ: Dahl's bristle at the rotor.

    z ∈ [-1, 1] is the share of friction that is mobilised; it turns round within the angle δ.  The
    update is exact for a constant speed within the step.
    """

    port = "motor.torque"
    reads = {"speed": "motor.speed"}
    state = {"mobilised": 0.0}
    neutral = {"sliding_torque": 0.0}
    traits = {"dissipative", "odd_in_speed", "rate_independent"}
    equation = "-T_p*mobilised"
    evolution = {"mobilised": "(speed - Abs(speed)*mobilised)/δ"}
    title = "presliding friction (Dahl)"
    signature = "After each reversal the effort turns round over a short way, at any speed alike."
    explanation = (
        "Before rubbing surfaces slide, their asperities and the lubricant bend like bristles: "
        "friction first acts as a spring and only then reaches its level."
    )
    tell_apart = {
        "coulomb_friction": "small reversals: only presliding friction turns round over a way",
        "capstan_friction": "two bends at the same tension: only capstan friction follows the bend",
        "gear_compliance": "unload and reload without reversing: a spring goes back the same way",
    }
    needs = "reversals, better small ones, sampled finely"
    references = ("Dahl, Aerospace Corp. TOR-0158 (1968)", "Bliman, Eur. J. Mechanics A 11 (1992)")

    sliding_torque: float = bounded(0.002, 0.0, 0.05, "N·m", "T_p", "level while sliding")
    presliding: float = bounded(
        0.2, 1e-5, 10.0, "rad", "δ", "angle in which friction turns round", log=True
    )

    @staticmethod
    def kernel(speed, mobilised, sliding_torque, presliding, dt):
        """Friction torque on the rotor [N·m] and the next mobilised share."""
        target = 1.0 if speed > 0.0 else -1.0
        mobilised = target + (mobilised - target) * math.exp(-abs(speed) * dt / presliding)
        return -sliding_torque * mobilised, mobilised
