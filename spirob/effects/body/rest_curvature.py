"""The unloaded arm is not straight."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class RestCurvature(Effect):
    """τ = k·q_0 at each hinge: the spring's rest angle is q_0 instead of zero."""

    port = "body.hinge_torque"
    reads = {"stiffness": "hinge.stiffness"}
    neutral = {"rest_angle": 0.0}
    traits = {"constant"}
    equation = "q_0*stiffness"
    title = "natural curvature of the unloaded arm"
    signature = "One tendon works harder than the other by an amount that stays the same."
    explanation = "Printing, storage or plastic set leave the arm with a bend of its own."
    tell_apart = {
        "current_offset": "swap the pulling tendon: a bend changes sign, an offset not",
        "mount_tilt": "turn the mount over: weight changes sides, a bend stays",
        "constant_force": "swap the pulling tendon: a bend changes sign, a force not",
    }
    needs = "pulling with either tendon in turn"
    references = ("Timoshenko, Strength of Materials: initial curvature (1930)",)

    rest_angle: float = bounded(0.02, -0.4, 0.4, "rad", "q_0", "rest angle of every hinge")

    @staticmethod
    def kernel(stiffness, rest_angle):
        """Torque at the hinge [N·m]."""
        return rest_angle * stiffness
