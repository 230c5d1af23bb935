"""A gear that passes torque differently when the load drives, and turns that round over a way."""

import math

from spirob.effects.effect import Effect
from spirob.effects.motor.direction_dependent_efficiency import (
    DirectionDependentEfficiency as OfTendon,
)
from spirob.parameter import bounded


class DirectionDependentEfficiency(Effect, told_as=OfTendon):
    """η → η·(1 + x·(1 - z·sgn i)/2), dz/dt = |ω|·(tanh(ω/(σ·ω_0)) - z)/δ.

    The losses of a gear are friction of its teeth, which turns round over a way as any dry friction
    does; x is the library's, ω_0 the speed at which the rig counts as standing.  The update is
    exact for a constant speed within the step.
    """

    port = "winch.efficiency"
    reads = {
        "speed": "motor.speed",
        "rest_speed": "motor.rest_speed",
        "current": "motor.current",
    }
    state = {"mobilised": 0.0}
    neutral = {"back_excess": 0.0}
    equation = "upstream*(1 + x*(1 - mobilised*sign(current))/2)"
    evolution = {"mobilised": "Abs(speed)*(tanh(speed/(σ*rest_speed)) - mobilised)/δ"}

    back_excess: float = bounded(0.3, 0.0, 9.0, "1", "x", "extra torque passed while driven")
    softness: float = bounded(1.0, 0.05, 10.0, "1", "σ", "rest speeds in which the sign turns")
    presliding: float = bounded(
        0.2, 1e-5, 10.0, "rad", "δ", "angle in which the losses turn round", log=True
    )

    @staticmethod
    def kernel(
        upstream,
        speed,
        rest_speed,
        current,
        mobilised,
        back_excess,
        softness,
        presliding,
        dt,
    ):
        """Torque at the drum over torque at the rotor and gear ratio [-], and the next share."""
        sign = 0.0
        if current != 0.0:
            sign = math.copysign(1.0, current)
        target = math.tanh(speed / (softness * rest_speed))
        mobilised = target + (mobilised - target) * math.exp(-abs(speed) * dt / presliding)
        return upstream * (1.0 + 0.5 * back_excess * (1.0 - sign * mobilised)), mobilised


class OfDescribedLoad(DirectionDependentEfficiency):
    """η → η·(1 - y·(1 + z·sgn i)/2 + x·(1 - z·sgn i)/2), x and z as of any load.

    Of a load that a model file describes, under efforts whose scale is given, no other number takes
    up what is lost while the motor drives: y, as x while the load does.
    """

    neutral = {"back_excess": 0.0, "forward_loss": 0.0}
    equation = "upstream*(1 + (x - y - (x + y)*mobilised*sign(current))/2)"

    forward_loss: float = bounded(0.1, 0.0, 0.9, "1", "y", "part of the torque lost while driving")

    @staticmethod
    def kernel(
        upstream,
        speed,
        rest_speed,
        current,
        mobilised,
        back_excess,
        softness,
        presliding,
        forward_loss,
        dt,
    ):
        """Torque at the drum over torque at the rotor and gear ratio [-], and the next share."""
        sign = 0.0
        if current != 0.0:
            sign = math.copysign(1.0, current)
        target = math.tanh(speed / (softness * rest_speed))
        mobilised = target + (mobilised - target) * math.exp(-abs(speed) * dt / presliding)
        along = sign * mobilised
        passed = 1.0 + 0.5 * back_excess * (1.0 - along) - 0.5 * forward_loss * (1.0 + along)
        return upstream * passed, mobilised
