"""Torque that pulls the rotor towards preferred angles."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class Cogging(Effect):
    """τ = Σ A_j·sin κ_jNθ + B_j·cos κ_jNθ at the rotor, j = 1, 2, 3 with κ_1 = 1.

    Cogging is not a sine: its second harmonic (κ = 2) is often a third of the first.  The stages of
    a gear add waves of their own, whose orders have nothing to do with the magnets', so the κ need
    not be whole; the slowest comes round with the gear's output.
    """

    port = "motor.torque"
    reads = {"angle": "motor.angle"}
    neutral = {
        "sine": 0.0,
        "cosine": 0.0,
        "second_sine": 0.0,
        "second_cosine": 0.0,
        "third_sine": 0.0,
        "third_cosine": 0.0,
    }
    traits = {"rate_independent"}
    equation = (
        "A*sin(N*angle) + B*cos(N*angle) + A_2*sin(κ*N*angle) + B_2*cos(κ*N*angle)"
        " + A_3*sin(κ_3*N*angle) + B_3*cos(κ_3*N*angle)"
    )
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
    third_sine: float = bounded(0.0, -0.05, 0.05, "N·m", "A_3", "third wave in phase")
    third_cosine: float = bounded(0.0, -0.05, 0.05, "N·m", "B_3", "third wave in quadrature")
    order: float = bounded(
        1.0, 0.01, 100.0, "1", "N", "periods in a turn of the rotor", log=True, geared=True
    )
    ratio: float = bounded(2.0, 1.0, 1e3, "1", "κ", "order of the second wave over N", log=True)
    third_ratio: float = bounded(
        3.0, 1.0, 1e3, "1", "κ_3", "order of the third wave over N", log=True
    )

    @staticmethod
    def kernel(
        angle,
        sine,
        cosine,
        second_sine,
        second_cosine,
        third_sine,
        third_cosine,
        order,
        ratio,
        third_ratio,
    ):
        """Cogging torque on the rotor [N·m]."""
        one, two, three = order * angle, ratio * order * angle, third_ratio * order * angle
        first = sine * math.sin(one) + cosine * math.cos(one)
        second = second_sine * math.sin(two) + second_cosine * math.cos(two)
        third = third_sine * math.sin(three) + third_cosine * math.cos(three)
        return first + second + third
