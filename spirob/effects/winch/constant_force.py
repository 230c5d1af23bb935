"""A steady force on the winch that the model does not know."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class ConstantForce(Effect):
    """F = F_0 on each winch, positive when it helps winding in."""

    port = "tendon.force"
    neutral = {"force": 0.0}
    traits = {"constant"}
    equation = "F_0"
    title = "a constant force on the transmission"
    signature = "The same effort everywhere, in either direction of motion, and in holds."
    explanation = "A spring, a weight or a tilted mount pulls on the transmission all the time."
    tell_apart = {
        "current_offset": "free the load: a force on it goes, an offset stays",
        "asymmetric_viscous_friction": "holds and two speeds each way: a force stays in holds",
        "rest_curvature": "swap the pulling tendon: a force stays, a bend changes sign",
    }
    needs = "both directions of motion, or holds"
    references = ("Janot, Gautier, Brunot, data set and reference models of EMPS (2019)",)

    force: float = bounded(0.3, -50.0, 50.0, "N", "F_0", "steady force, + winds in")

    @staticmethod
    def kernel(force):
        """Force on the winch [N]."""
        return force
