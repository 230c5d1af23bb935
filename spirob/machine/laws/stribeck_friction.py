"""Dry friction of an axis with a breakaway peak, which turns round over a way."""

import math

from spirob.effects.effect import Effect
from spirob.effects.motor.stribeck_friction import StribeckFriction as OfRotor
from spirob.parameter import bounded


class StribeckFriction(Effect, told_as=OfRotor):
    """τ = -T_s·z, dz/dt = |ω|·(tanh(ω/(σ·ω_0)) - z/g)/δ, g·T_s = T_c + T_x·exp(-(ω/(s·ω_0))²).

    T_s = T_c + T_x is the breakaway level, ω_0 the speed at which the rig counts as standing.  With
    a small σ these are the bristles of LuGre (Canudas de Wit et al., 1995), T_s = σ₀·δ, undamped;
    where δ is small, friction follows the sign of the speed, which σ softens.  The update is exact
    for a constant speed within the step.
    """

    port = "motor.torque"
    reads = {"speed": "motor.speed", "rest_speed": "motor.rest_speed"}
    state = {"mobilised": 0.0}
    neutral = {"coulomb_torque": 0.0, "breakaway_excess": 0.0}
    traits = {"dissipative", "odd_in_speed"}
    equation = "-(T_c + T_x)*mobilised"
    evolution = {
        "mobilised": "Abs(speed)*(tanh(speed/(σ*rest_speed))"
        " - mobilised*(T_c + T_x)/(T_c + T_x*exp(-(speed/(s*rest_speed))**2)))/δ"
    }

    coulomb_torque: float = bounded(0.001, 0.0, 0.05, "N·m", "T_c", "level while sliding")
    breakaway_excess: float = bounded(0.001, 0.0, 0.05, "N·m", "T_x", "extra level near rest")
    stribeck_ratio: float = bounded(
        4.0, 1.0, 50.0, "1", "s", "rest speeds at which the peak is gone"
    )
    softness: float = bounded(0.5, 0.05, 10.0, "1", "σ", "rest speeds in which the sign turns")
    presliding: float = bounded(
        0.2, 1e-5, 10.0, "rad", "δ", "angle in which friction turns round", log=True
    )

    @staticmethod
    def kernel(
        speed,
        rest_speed,
        mobilised,
        coulomb_torque,
        breakaway_excess,
        stribeck_ratio,
        softness,
        presliding,
        dt,
    ):
        """Friction torque on the axis [N·m] and the next mobilised share of the breakaway level."""
        most = coulomb_torque + breakaway_excess
        fall = math.exp(-((speed / (stribeck_ratio * rest_speed)) ** 2))
        level = max((coulomb_torque + breakaway_excess * fall) / most, 1e-9) if most > 0.0 else 1.0
        target = level * math.tanh(speed / (softness * rest_speed))
        decay = math.exp(-abs(speed) * dt / (presliding * level))
        mobilised = target + (mobilised - target) * decay
        return -most * mobilised, mobilised
