"""Torque that pulls the rotor towards preferred angles."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class Cogging(Effect):
    """τ = A·sin Nθ + B·cos Nθ + A_2·sin 2Nθ + B_2·cos 2Nθ at the rotor.

    Cogging is not a sine: its second harmonic is often a third of the first.
    """

    port = "motor.torque"
    reads = {"angle": "motor.angle"}
    neutral = {"sine": 0.0, "cosine": 0.0, "second_sine": 0.0, "second_cosine": 0.0}
    traits = {"rate_independent"}
    equation = "A*sin(N*angle) + B*cos(N*angle) + A_2*sin(2*N*angle) + B_2*cos(2*N*angle)"
    title = "cogging"
    signature = "A ripple that is periodic in the motor's angle, whatever the speed or current."
    explanation = "Magnets prefer to stand opposite the stator's teeth, with or without current."
    tell_apart = {
        "torque_ripple": "a second load: cogging stays, ripple grows with the current",
        "eccentric_winch": "a second load: cogging stays, eccentricity grows with the tension",
        "encoder_eccentricity": "two speeds: a reading error in speed grows with the speed",
    }
    needs = "several periods of the angle, slowly"
    references = ("Hanselman, Brushless Permanent-Magnet Motor Design (1994)",)

    sine: float = bounded(0.001, -0.05, 0.05, "N·m", "A", "amplitude in phase")
    cosine: float = bounded(0.0, -0.05, 0.05, "N·m", "B", "amplitude in quadrature")
    second_sine: float = bounded(0.0, -0.05, 0.05, "N·m", "A_2", "second harmonic in phase")
    second_cosine: float = bounded(0.0, -0.05, 0.05, "N·m", "B_2", "second harmonic in quadrature")
    order: float = bounded(1.0, 0.01, 100.0, "1", "N", "periods in a turn of the rotor")

    @staticmethod
    def kernel(angle, sine, cosine, second_sine, second_cosine, order):
        """Cogging torque on the rotor [N·m]."""
        phase = order * angle
        first = sine * math.sin(phase) + cosine * math.cos(phase)
        return first + second_sine * math.sin(2.0 * phase) + second_cosine * math.cos(2.0 * phase)
