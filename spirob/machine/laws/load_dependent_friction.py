"""Friction by the load of an axis, whose motor's own inertia no gear carries."""

import math

from spirob.effects.effect import Effect
from spirob.effects.motor.load_dependent_friction import LoadDependentFriction as OfTendon
from spirob.parameter import bounded


class LoadDependentFriction(Effect, told_as=OfTendon):
    """τ = -m·|τ_load - μ·J·a|·z, dz/dt = |ω|·(tanh(ω/(σ·ω_0)) - z)/δ; ω_0 as in `coulomb_friction`.

    Like any dry friction it turns round over a way: bristles of Dahl (1968), whose level the load
    sets; where δ is small it follows the sign of the speed, which σ softens.  The update is exact
    for a constant speed within the step.

    Of an axis whose body nobody described τ_load holds all that is moved; μ is the share of its
    inertia J that turns ahead of the gear, and presses on no teeth.  At m = 1 a
    gear holds its load by itself, and no load drives it back: m ends there.
    """

    port = "motor.torque"
    reads = {
        "speed": "motor.speed",
        "rest_speed": "motor.rest_speed",
        "load": "motor.load_torque",
        "inertia_torque": "motor.inertia_torque",
    }
    state = {"mobilised": 0.0}
    neutral = {"loss_ratio": 0.0}
    traits = {"dissipative"}
    equation = "-m*Abs(load - μ*inertia_torque)*mobilised"
    evolution = {"mobilised": "Abs(speed)*(tanh(speed/(σ*rest_speed)) - mobilised)/δ"}

    loss_ratio: float = bounded(0.05, 0.0, 1.0, "1", "m", "lost part of the load torque")
    softness: float = bounded(1.0, 0.05, 10.0, "1", "σ", "rest speeds in which the sign turns")
    rotor_share: float = bounded(
        0.3, 0.0, 1.0, "1", "μ", "share of the inertia that moves with the motor"
    )

    presliding: float = bounded(
        0.2, 1e-5, 10.0, "rad", "δ", "angle in which friction turns round", log=True
    )

    @staticmethod
    def kernel(
        speed,
        rest_speed,
        load,
        inertia_torque,
        mobilised,
        loss_ratio,
        softness,
        rotor_share,
        presliding,
        dt,
    ):
        """Friction torque on the axis, and the next mobilised share of its level."""
        target = math.tanh(speed / (softness * rest_speed))
        mobilised = target + (mobilised - target) * math.exp(-abs(speed) * dt / presliding)
        return -loss_ratio * abs(load - rotor_share * inertia_torque) * mobilised, mobilised
