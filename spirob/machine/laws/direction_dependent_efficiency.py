"""A gear's efficiency on an axis: what it gives back where the load drives the motor."""

import math

from spirob.effects.effect import Effect
from spirob.effects.motor.direction_dependent_efficiency import (
    DirectionDependentEfficiency as OfTendon,
)
from spirob.parameter import bounded


class DirectionDependentEfficiency(Effect):
    """τ = b·(τ_load - μ·J·a)·x/(1 + x),  b = (1 - tanh(ω/ω_0)·sgn(τ_load - μ·J·a))/2.

    While the load drives, the motor holds 1/(1 + x) of it and the gear the rest; x = 1/(η·η_back)
    - 1 for the efficiencies of driving, which `scale` holds, and of being driven.  Of an axis whose
    body nobody described τ_load holds all that is moved; μ is the share of its inertia J that turns
    ahead of the gear.
    """

    port = "motor.torque"
    reads = {
        "speed": "motor.speed",
        "rest_speed": "motor.rest_speed",
        "load": "motor.load_torque",
        "inertia_torque": "motor.inertia_torque",
    }
    neutral = {"back_excess": 0.0}
    equation = (
        "x/(1 + x)*(load - μ*inertia_torque)"
        "*(1 - tanh(speed/rest_speed)*sign(load - μ*inertia_torque))/2"
    )
    title = OfTendon.title
    signature = OfTendon.signature
    explanation = OfTendon.explanation
    tell_apart = OfTendon.tell_apart
    needs = OfTendon.needs
    references = OfTendon.references

    back_excess: float = bounded(0.3, 0.0, 1.5, "1", "x", "extra torque passed while driven")
    rotor_share: float = bounded(
        0.3, 0.0, 1.0, "1", "μ", "share of the inertia that moves with the motor"
    )

    @staticmethod
    def kernel(speed, rest_speed, load, inertia_torque, back_excess, rotor_share):
        """Torque of the gear on the axis, which holds a part of the load that drives."""
        carried = load - rotor_share * inertia_torque
        sign = 0.0
        if carried != 0.0:
            sign = math.copysign(1.0, carried)
        driven = 0.5 * (1.0 - sign * math.tanh(speed / rest_speed))
        return driven * carried * back_excess / (1.0 + back_excess)
