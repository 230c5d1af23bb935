"""Viscous friction that is larger in one direction of motion than in the other."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class AsymmetricViscousFriction(Effect):
    """τ = -D|ω|/2: what the damping b_m ± D/2 of the two directions has beside its mean.

    The mean is the symmetric friction, which the model has.  Dissipative together with it, as long
    as |D| ≤ 2 b_m; linear in D, so that a fit finds its way through zero.
    """

    port = "motor.torque"
    reads = {"speed": "motor.speed"}
    neutral = {"excess": 0.0}
    traits = {"even_in_speed"}
    equation = "-D*Abs(speed)/2"
    title = "viscous friction that differs between the two directions"
    signature = "Effort in proportion to speed in one direction and missing in the other."
    explanation = (
        "A seal's lip, a preloaded bearing or a one-sided guide drags more when the machine runs "
        "one way than the other."
    )
    tell_apart = {
        "constant_force": "holds and two speeds each way: a force stays when the motion stops",
        "current_offset": "holds and two speeds each way: an offset stays when the motion stops",
        "coulomb_friction": "two speeds each way: Coulomb friction is the same at both",
        "quadratic_drag": "the same speed both ways: drag is the same in both",
    }
    needs = "at least two speeds in each direction"
    references = ("Janot, Gautier, Brunot, data set and reference models of EMPS (2019)",)

    excess: float = bounded(
        2e-5, -1e-3, 1e-3, "N·m·s/rad", "D", "damping winding in less damping paying out"
    )

    @staticmethod
    def kernel(speed, excess):
        """Friction torque on the rotor [N·m]."""
        return -0.5 * excess * abs(speed)
