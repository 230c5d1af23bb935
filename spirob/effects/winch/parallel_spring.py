"""A spring between what the motor moves and its frame."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class ParallelSpring(Effect):
    """F = -(k·d + F_0) on each winch, with d the length that it has wound in.

    It is at rest at d = -F_0/k.  Where k is negative it pushes away from there, as a weight that is
    held upright does.  On the arm its hinges' stiffness does nearly the same.
    """

    port = "tendon.force"
    reads = {"displacement": "winch.displacement"}
    neutral = {"stiffness": 0.0, "bias": 0.0}
    traits = {"rate_independent"}
    equation = "-(k*displacement + F_0)"
    title = "a spring, or a weight over a small angle"
    signature = "Effort that grows in proportion to the way, alike in both directions of motion."
    explanation = (
        "A spring, a cable or a hose holds what the motor moves to its frame. A weight on a lever "
        "does the same over a small angle; held upright it pushes away from there."
    )
    tell_apart = {
        "constant_force": "hold poses far apart: a spring pulls more in one",
        "tip_payload": "a wider motion: a weight comes round with the turn, a spring only grows",
        "cogging": "a wider motion: magnets come round, a spring only grows",
    }
    stands_for = ("arm.base_stiffness",)
    needs = "poses far apart, slowly"
    references = ("Verstraten et al., Series and Parallel Elastic Actuation (2016)",)

    stiffness: float = bounded(10.0, -1e4, 1e4, "N/m", "k", "force for each length")
    bias: float = bounded(0.0, -1e4, 1e4, "N", "F_0", "force at zero")

    @staticmethod
    def kernel(displacement, stiffness, bias):
        """Force on the winch [N]."""
        return -(stiffness * displacement + bias)
