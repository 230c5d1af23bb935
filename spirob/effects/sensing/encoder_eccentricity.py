"""The encoder's disc or magnet does not sit in the middle of the shaft."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class EncoderEccentricity(Effect):
    """x_measured = x + a·sin Nθ + b·cos Nθ + a_2·sin 2Nθ + b_2·cos 2Nθ.

    Lengths count from where the trial begins.  A magnet off centre reads once a turn, one that is
    tilted or a ring that is oval twice.

    N = 1 for an encoder on the rotor, 1/G for one on the drum.  The measured velocity ripples with
    it, as a drive differentiates what it measures.
    """

    port = "sensing.displacement"
    reads = {"angle": "motor.angle"}
    neutral = {"sine": 0.0, "cosine": 0.0, "second_sine": 0.0, "second_cosine": 0.0}
    traits = {"rate_independent"}
    equation = (
        "upstream + a*sin(N*angle) + b*cos(N*angle) + a_2*sin(2*N*angle) + b_2*cos(2*N*angle)"
    )
    title = "eccentricity of the encoder"
    signature = "A ripple once per turn of the encoder, in speed the larger the faster it turns."
    explanation = (
        "Off centre, the disc seems to turn faster on one side: the controller chases a ripple "
        "that is not in the motion."
    )
    tell_apart = {
        "cogging": "two speeds: the ripple in speed grows with the speed",
        "eccentric_winch": "a second load: a reading error shows no more effort",
    }
    needs = "several turns of the encoder at two speeds"
    references = ("Geometry: a disc of radius R off centre by e reads θ + e/R·sin θ",)

    sine: float = bounded(2e-5, -1e-3, 1e-3, "m", "a", "reading error in phase")
    cosine: float = bounded(0.0, -1e-3, 1e-3, "m", "b", "reading error in quadrature")
    second_sine: float = bounded(0.0, -1e-3, 1e-3, "m", "a_2", "twice a turn, in phase")
    second_cosine: float = bounded(0.0, -1e-3, 1e-3, "m", "b_2", "twice a turn, in quadrature")
    order: float = bounded(
        1.0,
        0.01,
        20.0,
        "1",
        "N",
        "turns of the encoder per turn of the rotor",
        log=True,
        geared=True,
    )

    @staticmethod
    def kernel(upstream, angle, sine, cosine, second_sine, second_cosine, order):
        """Wound-in length as the drive reports it [m]."""
        phase = order * angle
        once = sine * math.sin(phase) + cosine * math.cos(phase)
        twice = second_sine * math.sin(2.0 * phase) + second_cosine * math.cos(2.0 * phase)
        return upstream + once + twice
