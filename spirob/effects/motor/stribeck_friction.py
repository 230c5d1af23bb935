"""Friction that falls from a breakaway level to a sliding level as the shaft starts to turn."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class StribeckFriction(Effect):
    """τ = -(T_c + T_x·exp(-(ω/ω_s)²))·tanh(ω/ω_0) at the rotor."""

    port = "motor.torque"
    reads = {"speed": "motor.speed"}
    neutral = {"coulomb_torque": 0.0, "breakaway_excess": 0.0}
    traits = {"dissipative", "odd_in_speed"}
    equation = "-(T_c + T_x*exp(-(speed/w_s)**2))*tanh(speed/w_0)"
    title = "dry friction with a breakaway peak (Stribeck)"
    signature = "Effort odd in speed, largest just after breakaway, level at higher speed."
    explanation = (
        "At rest the lubricant film is squeezed out; it builds up again as the shaft turns, so "
        "that friction falls from its breakaway level to a lower sliding level."
    )
    tell_apart = {"coulomb_friction": "a slow crawl and restarts: only Stribeck friction peaks"}
    references = ("Armstrong-Hélouvry, Dupont, Canudas de Wit, Automatica 30 (1994)",)

    coulomb_torque: float = bounded(0.001, 0.0, 0.05, "N·m", "T_c", "level while sliding")
    breakaway_excess: float = bounded(0.001, 0.0, 0.05, "N·m", "T_x", "extra level near rest")
    stribeck_speed: float = bounded(8.0, 0.5, 60.0, "rad/s", "w_s", "speed where the peak is gone")
    smoothing_speed: float = bounded(1.0, 0.05, 20.0, "rad/s", "w_0", "speed of the smooth sign")

    @staticmethod
    def kernel(speed, coulomb_torque, breakaway_excess, stribeck_speed, smoothing_speed):
        """Friction torque on the rotor [N·m]."""
        peak = breakaway_excess * math.exp(-((speed / stribeck_speed) ** 2))
        return -(coulomb_torque + peak) * math.tanh(speed / smoothing_speed)
