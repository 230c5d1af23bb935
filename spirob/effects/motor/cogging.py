"""Torque that pulls the rotor towards preferred angles."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class Cogging(Effect):
    """τ = A·sin Nθ + B·cos Nθ + A_2·sin κNθ + B_2·cos κNθ at the rotor.

    Cogging is not a sine: its second harmonic (κ = 2) is often a third of the first.  A gear adds
    waves of its own, whose orders have nothing to do with the magnets', so κ need not be whole.
    """

    port = "motor.torque"
    reads = {"angle": "motor.angle"}
    neutral = {"sine": 0.0, "cosine": 0.0, "second_sine": 0.0, "second_cosine": 0.0}
    traits = {"rate_independent"}
    equation = "A*sin(N*angle) + B*cos(N*angle) + A_2*sin(κ*N*angle) + B_2*cos(κ*N*angle)"
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
    second_sine: float = bounded(0.0, -0.05, 0.05, "N·m", "A_2", "second wave in phase")
    second_cosine: float = bounded(0.0, -0.05, 0.05, "N·m", "B_2", "second wave in quadrature")
    order: float = bounded(1.0, 0.01, 100.0, "1", "N", "periods in a turn of the rotor")
    ratio: float = bounded(2.0, 1e-3, 1e3, "1", "κ", "order of the second wave over N", log=True)

    @staticmethod
    def kernel(angle, sine, cosine, second_sine, second_cosine, order, ratio):
        """Cogging torque on the rotor [N·m]."""
        one, two = order * angle, ratio * order * angle
        first = sine * math.sin(one) + cosine * math.cos(one)
        return first + second_sine * math.sin(two) + second_cosine * math.cos(two)
