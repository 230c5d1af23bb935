"""Friction in proportion to the load that the gear carries."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class LoadDependentFriction(Effect):
    """τ = -m·|τ_load|·tanh(ω/(σ·ω_0)) at the rotor; ω_0 as in `coulomb_friction`."""

    port = "motor.torque"
    reads = {
        "speed": "motor.speed",
        "rest_speed": "motor.rest_speed",
        "load": "motor.load_torque",
    }
    neutral = {"loss_ratio": 0.0}
    traits = {"dissipative", "odd_in_speed"}
    equation = "-m*Abs(load)*tanh(speed/(σ*rest_speed))"
    title = "load-dependent friction in the gear"
    signature = "A loop between winding in and paying out whose height grows with the load."
    explanation = (
        "Gear teeth press harder on each other under load, and rub in proportion: lifting costs "
        "more than the constant efficiency says, and lowering gives back less."
    )
    tell_apart = {
        "coulomb_friction": "a second load: the loop's height follows the load",
        "capstan_friction": "two bends at the same tension: only capstan friction follows the bend",
        "direction_dependent_efficiency": "winding in alone: only this friction adds to it",
    }
    needs = "two loads that differ by a factor of two, in both directions of motion"
    references = ("Hamon, Gautier, Garrec, friction depending on load and velocity, IROS (2010)",)

    loss_ratio: float = bounded(0.05, 0.0, 0.6, "1", "m", "lost part of the load torque")
    softness: float = bounded(1.0, 0.05, 10.0, "1", "σ", "rest speeds in which the sign turns")

    @staticmethod
    def kernel(speed, rest_speed, load, loss_ratio, softness):
        """Friction torque on the rotor [N·m]."""
        return -loss_ratio * abs(load) * math.tanh(speed / (softness * rest_speed))
