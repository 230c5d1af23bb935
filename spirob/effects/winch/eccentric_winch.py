"""A drum that is not round, or does not turn about its centre."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class EccentricWinch(Effect):
    """r → r·(1 + a·sin φ + b·cos φ + a_2·sin 2φ + b_2·cos 2φ).

    φ is the drum's angle since the start of the trial; the second wave is that of an oval drum.
    The same radius acts on motion per turn and on torque per tension, as it does in a real drum.
    """

    port = "winch.radius"
    reads = {"angle": "winch.angle"}
    neutral = {"sine": 0.0, "cosine": 0.0, "oval_sine": 0.0, "oval_cosine": 0.0}
    traits = {"rate_independent"}
    equation = "upstream*(1 + a*sin(angle) + b*cos(angle) + a_2*sin(2*angle) + b_2*cos(2*angle))"
    title = "eccentricity of the drum"
    signature = "A wave once per turn of the drum, in effort and in motion per turn together."
    explanation = (
        "The drum's axis misses its centre, so that a turn winds in faster on one side than on the "
        "other and the tension has a longer or shorter lever."
    )
    tell_apart = {
        "cogging": "a second load: the wave grows with the tension, cogging stays",
        "torque_ripple": "the length channel: only an eccentric drum varies motion per turn",
        "drum_build_up": "several turns: eccentricity comes round, build-up goes one way",
        "encoder_eccentricity": "a second load: a reading error shows no more effort",
    }
    needs = "a turn of the drum or more"
    references = ("Geometry: a circle that turns about a point beside its centre, to first order",)

    sine: float = bounded(0.02, -0.3, 0.3, "1", "a", "relative eccentricity in phase")
    cosine: float = bounded(0.0, -0.3, 0.3, "1", "b", "relative eccentricity in quadrature")
    oval_sine: float = bounded(0.0, -0.3, 0.3, "1", "a_2", "oval part in phase")
    oval_cosine: float = bounded(0.0, -0.3, 0.3, "1", "b_2", "oval part in quadrature")

    @staticmethod
    def kernel(upstream, angle, sine, cosine, oval_sine, oval_cosine):
        """Effective radius [m]."""
        once = sine * math.sin(angle) + cosine * math.cos(angle)
        twice = oval_sine * math.sin(2.0 * angle) + oval_cosine * math.cos(2.0 * angle)
        return upstream * (1.0 + once + twice)
