"""Dry friction of an axis that winds up like a damped spring before it breaks away."""

import math

from spirob.effects.effect import Effect
from spirob.effects.motor.presliding_friction import PreslidingFriction as OfRotor
from spirob.parameter import bounded


class PreslidingFriction(Effect):
    """τ = -T_p·(z + c·dz/dt), dz/dt = (ω - |ω|·z)/δ: Dahl's bristle, damped as LuGre's is.

    c is the damping of the bristles over their stiffness, σ₁/σ₀ of LuGre (Canudas de Wit et al.,
    1995), with T_p = σ₀·δ.  The update is exact for a constant speed within the step; dz/dt is that
    of its end.
    """

    port = "motor.torque"
    reads = {"speed": "motor.speed"}
    state = {"mobilised": 0.0}
    neutral = {"sliding_torque": 0.0}
    traits = {"dissipative", "odd_in_speed"}
    equation = "-T_p*(mobilised + c*(speed - Abs(speed)*mobilised)/δ)"
    evolution = {"mobilised": "(speed - Abs(speed)*mobilised)/δ"}
    title = OfRotor.title
    signature = OfRotor.signature
    explanation = OfRotor.explanation
    tell_apart = OfRotor.tell_apart
    needs = OfRotor.needs
    references = OfRotor.references

    sliding_torque: float = bounded(0.002, 0.0, 0.05, "N·m", "T_p", "level while sliding")
    presliding: float = bounded(
        0.2, 1e-5, 10.0, "rad", "δ", "angle in which friction turns round", log=True
    )
    damping: float = bounded(
        0.003, 1e-4, 0.3, "s", "c", "damping of the bristles over their stiffness", log=True
    )

    @staticmethod
    def kernel(speed, mobilised, sliding_torque, presliding, damping, dt):
        """Friction torque on the axis [N·m] and the next mobilised share."""
        target = 1.0 if speed > 0.0 else -1.0
        mobilised = target + (mobilised - target) * math.exp(-abs(speed) * dt / presliding)
        rate = (speed - abs(speed) * mobilised) / presliding
        return -sliding_torque * (mobilised + damping * rate), mobilised
