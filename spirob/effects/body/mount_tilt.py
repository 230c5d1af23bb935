"""The arm's plane is not level: part of its weight acts in it."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class MountTilt(Effect):
    """τ = W_y·sin ρ + W_x·sin φ at each hinge: gravity's components in the arm's plane.

    W_x, W_y are the torques of the weight beyond the hinge with gravity along and across the
    straight arm; both follow the arm's pose.
    """

    port = "body.hinge_torque"
    reads = {"along": "hinge.weight_x", "across": "hinge.weight_y"}
    neutral = {"roll": 0.0, "pitch": 0.0}
    equation = "across*sin(ρ) + along*sin(φ)"
    title = "tilt of the mount"
    signature = "A load that depends on the pose alone and favours one side."
    explanation = (
        "Mounted out of level, the arm hangs a little to one side: its weight helps one tendon "
        "and works against the other."
    )
    tell_apart = {
        "rest_curvature": "turn the mount over: weight changes sides, a bend stays",
        "constant_force": "several poses: only weight changes with the pose",
        "tip_payload": "hold a pose: a payload in a level plane loads only while it moves",
    }
    needs = "several poses to both sides, slowly"
    references = ("Craig, Introduction to Robotics, ch. 6 (1989)",)

    roll: float = bounded(0.03, -0.5, 0.5, "rad", "ρ", "tilt to the left, about the straight arm")
    pitch: float = bounded(0.0, -0.5, 0.5, "rad", "φ", "tilt forward, tip down")

    @staticmethod
    def kernel(along, across, roll, pitch):
        """Torque of the weight at the hinge [N·m]."""
        return across * math.sin(roll) + along * math.sin(pitch)
