"""Dry friction of constant size that opposes the rotor's motion."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class CoulombFriction(Effect):
    """τ = -T_c·tanh(ω/ω_0) at the rotor."""

    port = "motor.torque"
    reads = {"speed": "motor.speed"}
    neutral = {"coulomb_torque": 0.0}
    traits = {"dissipative", "odd_in_speed"}
    equation = "-T_c*tanh(speed/w_0)"
    title = "dry (Coulomb) friction in the motor or gearbox"
    signature = "An effort of constant size that flips its sign with the direction of motion."
    explanation = (
        "Bearings, brushes and gear teeth rub with a force that does not depend on speed or load."
    )
    tell_apart = {
        "stribeck_friction": "a slow crawl: Coulomb friction stays flat below 5 mm/s",
        "load_dependent_friction": "a second load: Coulomb friction stays the same",
        "capstan_friction": "two bends at the same tension: Coulomb friction stays the same",
    }
    references = ("Armstrong-Hélouvry, Dupont, Canudas de Wit, Automatica 30 (1994)",)

    coulomb_torque: float = bounded(0.002, 0.0, 0.05, "N·m", "T_c", "level while sliding")
    smoothing_speed: float = bounded(2.0, 0.05, 20.0, "rad/s", "w_0", "speed of the smooth sign")

    @staticmethod
    def kernel(speed, coulomb_torque, smoothing_speed):
        """Friction torque on the rotor [N·m]."""
        return -coulomb_torque * math.tanh(speed / smoothing_speed)
