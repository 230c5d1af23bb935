"""The drum grows as tendon is wound onto it."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class DrumBuildUp(Effect):
    """r² = r_0²·(1 + 2·g·x): each length of tendon adds its own cross-section to the pile.

    To first order r = r_0·(1 + g·x); for a line of thickness t stacked in one groove
    g = t/(2π·r_0²).  Paid out beyond the start, a fifth of the radius always remains.
    """

    port = "winch.radius"
    reads = {"displacement": "winch.displacement"}
    neutral = {"growth": 0.0}
    traits = {"rate_independent"}
    equation = "upstream*sqrt(Max(1 + 2*g*displacement, 0.04))"
    title = "build-up of tendon on the drum"
    signature = "Effort and motion per turn grow together as tendon is wound in."
    explanation = "Layers of tendon pile up on the drum, so each turn winds in a little more."
    tell_apart = {
        "stiffness_hardening": "the length channel: build-up changes motion per turn",
        "eccentric_winch": "several turns: build-up goes one way, eccentricity comes round",
    }
    needs = "a stroke of a turn of the drum or more, with the length measured beside the angle"
    references = ("Geometry: the area of the pile is thickness times length",)

    growth: float = bounded(0.3, 0.0, 3.0, "1/m", "g", "relative growth of radius per length")

    @staticmethod
    def kernel(upstream, displacement, growth):
        """Effective radius [m]."""
        return upstream * math.sqrt(max(1.0 + 2.0 * growth * displacement, 0.04))
