"""The drum grows as tendon is wound onto it."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class DrumBuildUp(Effect):
    """r = r_0·(1 + g·x): the effective radius grows with the wound-in length."""

    port = "winch.radius"
    reads = {"displacement": "winch.displacement"}
    neutral = {"growth": 0.0}
    equation = "upstream*(1 + g*displacement)"
    title = "build-up of tendon on the drum"
    signature = "Effort and motion per turn grow together as tendon is wound in."
    explanation = "Layers of tendon pile up on the drum, so each turn winds in a little more."
    tell_apart = {"stiffness_hardening": "the length channel: build-up changes motion per turn"}

    growth: float = bounded(0.3, -3.0, 3.0, "1/m", "g", "relative growth of radius per length")

    @staticmethod
    def kernel(upstream, displacement, growth):
        """Effective radius [m]."""
        return upstream * (1.0 + growth * displacement)
