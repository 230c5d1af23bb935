"""Something hangs at the arm's tip that the model does not carry."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class TipPayload(Effect):
    """A point mass m at the end of the last unit: part of the body, with inertia and weight.

    The body is built with it, because an inertia that weighs a hundred times the last unit could
    not be added as a torque.
    """

    port = "body.tip_mass"
    neutral = {"mass": 0.0}
    traits = {"constant"}
    equation = "m"
    title = "payload at the tip"
    signature = "Effort with every acceleration of the tip, slower swings, and weight if tilted."
    explanation = "A gripper, a sensor or an object at the tip has to be swung along."
    tell_apart = {
        "mount_tilt": "hold a pose in a level plane: a payload then loads nothing",
        "joint_viscoelasticity": "quick stops: a payload swings on, viscosity damps",
    }
    needs = "quick starts and stops, or gravity in the arm's plane"
    references = ("Khalil, Dombre, Modeling, Identification and Control of Robots (2002)",)

    mass: float = bounded(0.02, 0.0, 0.5, "kg", "m", "mass at the tip")

    @staticmethod
    def kernel(mass):
        """Mass at the tip [kg]."""
        return mass
