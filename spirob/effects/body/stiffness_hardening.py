"""The hinges get stiffer, or softer, the more they bend."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class StiffnessHardening(Effect):
    """τ = -h·k·q³ at each hinge, with k its linear stiffness."""

    port = "body.hinge_torque"
    reads = {"angle": "hinge.angle", "stiffness": "hinge.stiffness"}
    neutral = {"hardening": 0.0}
    traits = {"rate_independent"}
    equation = "-h*stiffness*angle**3"
    title = "hardening of the arm's stiffness with bending"
    signature = "Effort that grows faster than the bend, the same in both directions of motion."
    explanation = "Bent far, the material and its folds resist more than in proportion."
    tell_apart = {
        "drum_build_up": "the length channel: hardening leaves the motion per turn alone",
        "joint_viscoelasticity": "the same stroke at two speeds, with holds",
        "torque_constant_saturation": "a known weight: hardening follows the bend, not the current",
    }
    needs = "bends up to a large share of the end stop"
    references = ("Ogden, Non-Linear Elastic Deformations (1984)",)

    hardening: float = bounded(1.0, -2.5, 20.0, "1/rad²", "h", "relative growth of stiffness")

    @staticmethod
    def kernel(angle, stiffness, hardening):
        """Torque at the hinge [N·m]."""
        return -hardening * stiffness * angle * angle * angle
