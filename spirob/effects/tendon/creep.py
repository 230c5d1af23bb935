"""The tendon grows longer while it is loaded."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class Creep(Effect):
    """Extra length z, dz/dt = (c·F - z)/T: a Kelvin-Voigt element in series with the tendon.

    The update is exact for a constant tension within the step.
    """

    port = "tendon.extra_length"
    reads = {"tension": "tendon.tension"}
    state = {"crept": 0.0}
    neutral = {"compliance": 0.0}
    equation = "crept"
    evolution = {"crept": "(c*tension - crept)/T"}
    title = "creep of the tendon"
    signature = "Length that grows during a loaded hold and comes back slowly when it ends."
    explanation = (
        "Under load the fibres' molecules slide past each other: the tendon keeps growing for a "
        "while, and shrinks again when the load goes."
    )
    tell_apart = {
        "stretch": "holds: only creep grows with time",
        "gear_compliance": "holds: only creep grows with time",
        "joint_viscoelasticity": "the length channel in a hold: only creep moves it",
        "winding_heating": "the length channel in a hold: only creep moves it",
    }
    needs = "loaded holds as long as the creep time, and the length channel"
    references = ("Findley, Lai, Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials",)

    compliance: float = bounded(5e-5, 0.0, 1e-3, "m/N", "c", "length gained in the end per tension")
    time: float = bounded(1.0, 0.1, 100.0, "s", "T", "creep time", log=True)

    @staticmethod
    def kernel(tension, crept, compliance, time, dt):
        """Length that the tendon has gained [m], and its next value [m]."""
        final = compliance * tension
        crept = final + (crept - final) * math.exp(-dt / time)
        return crept, crept
