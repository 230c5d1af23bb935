"""A gear that passes torque differently when the load drives the motor."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class DirectionDependentEfficiency(Effect):
    """η → η·(1 + x·b), b = (1 - tanh(ω/ω_0)·sgn i)/2: 0 while driving, 1 while driven.

    A constant η in τ = η·G·k_t·i makes energy out of nothing when the load drives the motor: the
    gear's losses then help the motor to hold, η·(1 + x) = 1/η_back ≥ 1.  Losses in proportion f
    to the motor's torque make 1 + x = (1 + f)/(1 - f); x ends at 9, where f is 0.8.
    """

    port = "winch.efficiency"
    reads = {
        "speed": "motor.speed",
        "rest_speed": "motor.rest_speed",
        "current": "motor.current",
    }
    neutral = {"back_excess": 0.0}
    equation = "upstream*(1 + x*(1 - tanh(speed/rest_speed)*sign(current))/2)"
    title = "gear efficiency that depends on the direction of power"
    signature = "While the load drives the motor, less current holds it than while winding in."
    explanation = (
        "A gear's losses always take from the side that drives.  Paying out under load, the load "
        "drives: the gear then carries part of it, and the motor needs less current."
    )
    tell_apart = {
        "load_dependent_friction": "winding in alone: its efficiency stays what it was",
        "coulomb_friction": "a second load: the difference follows the load",
    }
    needs = "paying out under load, beside winding in"
    references = ("Wang, Kim, Directional efficiency in geared transmissions, ICRA (2015)",)

    back_excess: float = bounded(0.3, 0.0, 9.0, "1", "x", "extra torque passed while driven")

    @staticmethod
    def kernel(upstream, speed, rest_speed, current, back_excess):
        """Torque at the drum over torque at the rotor and gear ratio [-]."""
        sign = 0.0
        if current != 0.0:
            sign = math.copysign(1.0, current)
        driven = 0.5 * (1.0 - sign * math.tanh(speed / rest_speed))
        return upstream * (1.0 + back_excess * driven)
