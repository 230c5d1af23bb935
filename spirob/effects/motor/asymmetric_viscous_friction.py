"""Viscous friction that is larger in one direction of motion than in the other."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class AsymmetricViscousFriction(Effect):
    """τ = -D·ω while winding in, if D > 0;  τ = -|D|·ω while paying out, if D < 0.

    Only the excess over the symmetric friction, which the model has: one number, dissipative for
    either sign.
    """

    port = "motor.torque"
    reads = {"speed": "motor.speed"}
    neutral = {"excess": 0.0}
    traits = {"dissipative"}
    equation = "-Max(D, 0)*Max(speed, 0) - Max(-D, 0)*Min(speed, 0)"
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
        2e-5, -1e-3, 1e-3, "N·m·s/rad", "D", "extra friction winding in (+) or paying out (-)"
    )

    @staticmethod
    def kernel(speed, excess):
        """Friction torque on the rotor [N·m]."""
        if speed * excess > 0.0:
            return -abs(excess) * speed
        return 0.0
