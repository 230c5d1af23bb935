"""Friction that falls from a breakaway level to a sliding level as the shaft starts to turn."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class StribeckFriction(Effect):
    """τ = -(T_c + T_x·exp(-(ω/(s·ω_0))²))·tanh(ω/(σ·ω_0)) at the rotor.

    ω_0 is the speed at which the rig counts as standing; s and σ count in it.
    """

    port = "motor.torque"
    reads = {"speed": "motor.speed", "rest_speed": "motor.rest_speed"}
    neutral = {"coulomb_torque": 0.0, "breakaway_excess": 0.0}
    traits = {"dissipative", "odd_in_speed"}
    equation = "-(T_c + T_x*exp(-(speed/(s*rest_speed))**2))*tanh(speed/(σ*rest_speed))"
    title = "dry friction with a breakaway peak (Stribeck)"
    signature = "Effort odd in speed, largest just after breakaway, level at higher speed."
    explanation = (
        "At rest the lubricant film is squeezed out; it builds up again as the shaft turns, so "
        "that friction falls from its breakaway level to a lower sliding level."
    )
    tell_apart = {
        "coulomb_friction": "a slow crawl and restarts: only Stribeck friction peaks",
        "presliding_friction": "a slow crawl after breakaway: only Stribeck friction falls",
    }
    needs = "a slow crawl and restarts from standstill"
    references = ("Armstrong-Hélouvry, Dupont, Canudas de Wit, Automatica 30 (1994)",)

    coulomb_torque: float = bounded(0.001, 0.0, 0.05, "N·m", "T_c", "level while sliding")
    breakaway_excess: float = bounded(0.001, 0.0, 0.05, "N·m", "T_x", "extra level near rest")
    stribeck_ratio: float = bounded(
        4.0, 1.0, 50.0, "1", "s", "rest speeds at which the peak is gone"
    )
    softness: float = bounded(0.5, 0.05, 10.0, "1", "σ", "rest speeds in which the sign turns")

    @staticmethod
    def kernel(speed, rest_speed, coulomb_torque, breakaway_excess, stribeck_ratio, softness):
        """Friction torque on the rotor [N·m]."""
        peak = breakaway_excess * math.exp(-((speed / (stribeck_ratio * rest_speed)) ** 2))
        return -(coulomb_torque + peak) * math.tanh(speed / (softness * rest_speed))
