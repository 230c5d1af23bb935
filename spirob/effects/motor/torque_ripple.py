"""A torque constant that varies within a turn."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class TorqueRipple(Effect):
    """τ → τ·(1 + a·sin Nθ + b·cos Nθ + a_2·sin κNθ + b_2·cos κNθ): k_t·i ripples with the angle.

    A weak magnet shows once a turn, an offset of a phase current once and its gain twice an
    electrical turn, so a second wave of an order of its own (κN) stands beside the first.  What k_t
    does it does again with the next turn, so no wave is slower than that (0.9: a fit's margin);
    slower ones stand for anything smooth, such as a drum that grows.  A wave as large as k_t
    would turn it round: its amplitudes end at 1.
    """

    port = "motor.drive_torque"
    reads = {"angle": "motor.angle"}
    neutral = {"sine": 0.0, "cosine": 0.0, "second_sine": 0.0, "second_cosine": 0.0}
    traits = {"rate_independent"}
    equation = (
        "upstream*(1 + a*sin(N*angle) + b*cos(N*angle) + a_2*sin(κ*N*angle) + b_2*cos(κ*N*angle))"
    )
    title = "torque ripple of the motor"
    signature = "A ripple periodic in the motor's angle whose size grows with the current."
    explanation = (
        "Back-EMF that is no pure sine, unequal phases and errors of commutation make the torque "
        "of an ampere depend on where the rotor stands."
    )
    tell_apart = {
        "cogging": "a second load: ripple grows with the current, cogging stays",
        "eccentric_winch": "the length channel: only an eccentric winch varies motion per turn",
    }
    needs = "several periods of the angle at two loads"
    references = ("Jahns, Soong, IEEE Trans. Industrial Electronics 43 (1996)",)

    sine: float = bounded(0.03, -1.0, 1.0, "1", "a", "relative amplitude in phase")
    cosine: float = bounded(0.0, -1.0, 1.0, "1", "b", "relative amplitude in quadrature")
    second_sine: float = bounded(0.0, -1.0, 1.0, "1", "a_2", "second wave in phase")
    second_cosine: float = bounded(0.0, -1.0, 1.0, "1", "b_2", "second wave in quadrature")
    order: float = bounded(6.0, 0.9, 100.0, "1", "N", "periods in a turn of the rotor", log=True)
    ratio: float = bounded(2.0, 1.0, 1e3, "1", "κ", "order of the second wave over N", log=True)

    @staticmethod
    def kernel(upstream, angle, sine, cosine, second_sine, second_cosine, order, ratio):
        """Torque of the motor at the rotor [N·m]."""
        one, two = order * angle, ratio * order * angle
        first = sine * math.sin(one) + cosine * math.cos(one)
        second = second_sine * math.sin(two) + second_cosine * math.cos(two)
        return upstream * (1.0 + first + second)
