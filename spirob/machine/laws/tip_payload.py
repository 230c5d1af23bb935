"""What a turning axis carries has weight: gravity on a lever that no model file describes."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class TipPayload(Effect):
    """τ = -(a·sin q + b·cos q): the weight m·g on its lever l, with a² + b² = (m·g·l)².

    q is the angle of the axis, whose zero may be anywhere: the weight hangs at q = -atan2(b, a).
    Its inertia m·l² is part of the fitted inertia.  For one axis in a fixed pose: where other
    joints move the lever, a model file says more.
    """

    port = "body.hinge_torque"
    reads = {"angle": "hinge.angle"}
    neutral = {"sine": 0.0, "cosine": 0.0}
    traits = {"rate_independent"}
    equation = "-(a*sin(angle) + b*cos(angle))"
    title = "weight on the axis' lever (gravity)"
    signature = "Effort that follows the angle alone, once round with each turn of the axis."
    explanation = (
        "What the axis carries is not balanced: gravity pulls it down, most where the lever is "
        "level, and not at all where it hangs or stands."
    )
    tell_apart = {
        "constant_force": "hold poses a quarter of a turn apart: a weight pulls less in one",
        "cogging": "a wider motion: a weight comes round once a turn of the axis, no sooner",
    }
    needs = "poses over a good part of a turn, slowly"
    references = ("Craig, Introduction to Robotics, ch. 6 (1989)",)

    sine: float = bounded(0.01, -1.0, 1.0, "N·m", "a", "moment at a quarter turn from zero")
    cosine: float = bounded(0.0, -1.0, 1.0, "N·m", "b", "moment at zero")

    @staticmethod
    def kernel(angle, sine, cosine):
        """Torque of the weight on the axis [N·m]."""
        return -(sine * math.sin(angle) + cosine * math.cos(angle))
