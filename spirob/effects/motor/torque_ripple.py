"""A torque constant that varies within a turn."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class TorqueRipple(Effect):
    """τ → τ·(1 + a·sin Nθ + b·cos Nθ): the motor's torque k_t·i ripples with the angle."""

    port = "motor.drive_torque"
    reads = {"angle": "motor.angle"}
    neutral = {"sine": 0.0, "cosine": 0.0}
    traits = {"rate_independent"}
    equation = "upstream*(1 + a*sin(N*angle) + b*cos(N*angle))"
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

    sine: float = bounded(0.03, -0.3, 0.3, "1", "a", "relative amplitude in phase")
    cosine: float = bounded(0.0, -0.3, 0.3, "1", "b", "relative amplitude in quadrature")
    order: float = bounded(6.0, 0.01, 100.0, "1", "N", "periods in a turn of the rotor")

    @staticmethod
    def kernel(upstream, angle, sine, cosine, order):
        """Torque of the motor at the rotor [N·m]."""
        return upstream * (1.0 + sine * math.sin(order * angle) + cosine * math.cos(order * angle))
