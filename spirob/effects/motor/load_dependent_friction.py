"""Friction in proportion to the load that the gear carries."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class LoadDependentFriction(Effect):
    """τ = -μ·|τ_load|·tanh(ω/ω_0) at the rotor."""

    port = "motor.torque"
    reads = {"speed": "motor.speed", "load": "motor.load_torque"}
    neutral = {"loss_ratio": 0.0}
    traits = {"dissipative", "odd_in_speed"}
    equation = "-m*Abs(load)*tanh(speed/w_0)"
    title = "load-dependent friction in the gear"
    signature = "A loop between winding in and paying out whose height grows with the load."
    explanation = (
        "Gear teeth press harder on each other under load, and rub in proportion: lifting costs "
        "more than the constant efficiency says, and lowering gives back less."
    )
    tell_apart = {
        "coulomb_friction": "a second load: the loop's height follows the load",
        "capstan_friction": "two bends at the same tension: only capstan friction follows the bend",
    }

    loss_ratio: float = bounded(0.05, 0.0, 0.6, "1", "m", "lost part of the load torque")
    smoothing_speed: float = bounded(2.0, 0.05, 20.0, "rad/s", "w_0", "speed of the smooth sign")

    @staticmethod
    def kernel(speed, load, loss_ratio, smoothing_speed):
        """Friction torque on the rotor [N·m]."""
        return -loss_ratio * abs(load) * math.tanh(speed / smoothing_speed)
