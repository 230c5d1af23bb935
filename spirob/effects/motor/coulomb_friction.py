"""Dry friction of constant size that opposes the rotor's motion."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class CoulombFriction(Effect):
    """τ = -T_c·tanh(ω/(σ·ω_0)) at the rotor.

    ω_0 is the speed at which the rig counts as standing; the sign turns round within σ of it, which
    keeps the torque continuous through zero on a fast rotor as on a slow carriage.
    """

    port = "motor.torque"
    reads = {"speed": "motor.speed", "rest_speed": "motor.rest_speed"}
    neutral = {"coulomb_torque": 0.0}
    traits = {"dissipative", "odd_in_speed"}
    equation = "-T_c*tanh(speed/(σ*rest_speed))"
    title = "dry (Coulomb) friction in the motor or gearbox"
    signature = "An effort of constant size that flips its sign with the direction of motion."
    explanation = (
        "Bearings, brushes and gear teeth rub with a force that does not depend on speed or load."
    )
    tell_apart = {
        "stribeck_friction": "a slow crawl: Coulomb friction stays flat down to standstill",
        "presliding_friction": "small reversals: Coulomb friction turns round at once",
        "load_dependent_friction": "a second load: Coulomb friction stays the same",
        "capstan_friction": "two bends at the same tension: Coulomb friction stays the same",
        "asymmetric_viscous_friction": "two speeds each way: Coulomb friction stays the same",
    }
    needs = "motion in both directions, or load and speed that vary independently"
    references = ("Armstrong-Hélouvry, Dupont, Canudas de Wit, Automatica 30 (1994)",)

    coulomb_torque: float = bounded(0.002, 0.0, 0.05, "N·m", "T_c", "level while sliding")
    softness: float = bounded(1.0, 0.05, 10.0, "1", "σ", "rest speeds in which the sign turns")

    @staticmethod
    def kernel(speed, rest_speed, coulomb_torque, softness):
        """Friction torque on the rotor [N·m]."""
        return -coulomb_torque * math.tanh(speed / (softness * rest_speed))
