"""Torque that pulls the rotor towards preferred angles."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class Cogging(Effect):
    """τ = A·sin(Nθ) + B·cos(Nθ) at the rotor."""

    port = "motor.torque"
    reads = {"angle": "motor.angle"}
    neutral = {"sine": 0.0, "cosine": 0.0}
    equation = "A*sin(N*angle) + B*cos(N*angle)"
    title = "cogging"
    signature = "A ripple that is periodic in the motor's angle, whatever the speed or current."
    explanation = "Magnets prefer to stand opposite the stator's teeth, with or without current."

    sine: float = bounded(0.001, -0.05, 0.05, "N·m", "A", "amplitude in phase")
    cosine: float = bounded(0.0, -0.05, 0.05, "N·m", "B", "amplitude in quadrature")
    order: float = bounded(1.0, 0.01, 100.0, "1", "N", "periods in a turn of the rotor")

    @staticmethod
    def kernel(angle, sine, cosine, order):
        """Cogging torque on the rotor [N·m]."""
        return sine * math.sin(order * angle) + cosine * math.cos(order * angle)
