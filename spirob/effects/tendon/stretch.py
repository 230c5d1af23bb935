"""The tendon is soft before it is stiff."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class Stretch(Effect):
    """e = F/k + s·(1 - exp(-F/F_0)): a toe of length s beside the linear elasticity.

    The port takes the secant compliance s·(1 - exp(-F/F_0))/F at the present tension, which the
    implicit tension then holds through the step.  With F_0 far above the tension it is a softer
    tendon, s/F_0 in series.
    """

    port = "tendon.compliance"
    reads = {"tension": "tendon.tension"}
    neutral = {"toe": 0.0}
    equation = "s*(1 - exp(-tension/F_0))/tension"
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
    references = ("McKenna, Hearle, O'Hear, Handbook of Fibre Rope Technology (2004)",)

    toe: float = bounded(1e-3, 0.0, 0.02, "m", "s", "length that comes out before it is stiff")
    toe_tension: float = bounded(2.0, 0.1, 200.0, "N", "F_0", "tension at which it does", log=True)

    @staticmethod
    def kernel(tension, toe, toe_tension):
        """Compliance in series with the tendon [m/N]."""
        relative = max(tension, 0.0) / toe_tension
        if relative < 1e-6:  # the quotient's limit; the next term is half of `relative`
            return toe / toe_tension
        return -toe / toe_tension * math.expm1(-relative) / relative
