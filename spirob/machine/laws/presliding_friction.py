"""Dry friction of an axis that winds up like a damped spring before it breaks away."""

import math

from spirob.effects.effect import Effect
from spirob.effects.motor.presliding_friction import PreslidingFriction as OfRotor
from spirob.parameter import bounded


class PreslidingFriction(Effect, told_as=OfRotor):
    """τ = -T_p·(z + c·dz/dt), dz/dt = ω/δ·(1 - z·sgn ω)^α: Dahl's bristle, damped as LuGre's is.

    α is how the bristle bends (Dahl, 1968): at 1 by and by, as LuGre's (Canudas de Wit et al.,
    1995), at 0 straight, as a spring that slips.  c is the damping of the bristles over their
    stiffness, σ₁/σ₀ of LuGre with T_p = σ₀·δ.  The update is exact for a constant speed within the
    step; dz/dt is that of its end.
    """

    port = "motor.torque"
    reads = {"speed": "motor.speed"}
    state = {"mobilised": 0.0}
    neutral = {"sliding_torque": 0.0}
    traits = {"dissipative", "odd_in_speed"}
    equation = "-T_p*(mobilised + c*speed*Max(0, 1 - mobilised*sign(speed))**α/δ)"
    evolution = {"mobilised": "speed*Max(0, 1 - mobilised*sign(speed))**α/δ"}

    sliding_torque: float = bounded(0.002, 0.0, 0.05, "N·m", "T_p", "level while sliding")
    presliding: float = bounded(
        0.2, 1e-5, 10.0, "rad", "δ", "angle in which friction turns round", log=True
    )
    damping: float = bounded(
        0.003, 1e-4, 0.3, "s", "c", "damping of the bristles over their stiffness", log=True
    )

    exponent: float = bounded(1.0, 0.0, 1.5, "1", "α", "how a bristle bends: at 0 it slips at once")

    @staticmethod
    def kernel(speed, mobilised, sliding_torque, presliding, damping, exponent, dt):
        """Friction torque on the axis [N·m] and the next mobilised share."""
        sign = 1.0 if speed > 0.0 else -1.0
        lacking = max(0.0, 1.0 - sign * mobilised)
        way, power = abs(speed) * dt / presliding, 1.0 - exponent
        if abs(power) < 1e-6:
            lacking *= math.exp(-way)
        elif lacking > 0.0:
            lacking = max(0.0, lacking**power - power * way) ** (1.0 / power)
        mobilised = sign * (1.0 - lacking)
        rate = speed * lacking**exponent / presliding if lacking > 0.0 else 0.0
        return -sliding_torque * (mobilised + damping * rate), mobilised
