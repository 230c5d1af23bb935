"""The tendon is soft before it is stiff."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class Stretch(Effect):
    """F = k·(e - s·(1 - exp(-e/s))): the slope grows from nothing to k over a toe of length s.

    The port takes the secant stiffness F/e at the present stretch e; the tension is then found
    implicitly with it.  It never falls below k/2000, that of a thousandth of the toe.
    """

    port = "tendon.stiffness"
    reads = {"stretch": "tendon.stretch"}
    neutral = {"toe": 0.0}
    traits = {"rate_independent"}
    equation = "upstream*(1 - (1 - exp(-Max(stretch/s, 1e-3)))/Max(stretch/s, 1e-3))"
    title = "stretch of the tendon at low tension"
    signature = "Length that gives way at small loads and firms up at larger ones, both ways alike."
    explanation = (
        "Strands of a braid straighten, knots and bends settle: the first newtons draw out more "
        "length than the later ones."
    )
    tell_apart = {
        "gear_compliance": "small and large loads: only stretch firms up",
        "backlash": "stay taut: stretch remains, play disappears",
        "creep": "holds: stretch does not grow with time",
        "drum_build_up": "two loads at the same length: build-up is the same at both",
    }
    needs = "the length channel from slack to full load"
    references = ("Fung, Biomechanics (1993): the exponential toe of tendons",)

    toe: float = bounded(5e-4, 0.0, 0.02, "m", "s", "length that comes out before it is stiff")

    @staticmethod
    def kernel(upstream, stretch, toe):
        """Stiffness of the tendon, tension per stretch [N/m]."""
        if toe <= 0.0:
            return upstream
        relative = max(stretch / toe, 1e-3)
        return upstream * (1.0 + math.expm1(-relative) / relative)
