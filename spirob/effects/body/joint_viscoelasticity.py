"""The arm's material relaxes: part of its stiffness fades with time."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class JointViscoelasticity(Effect):
    """A Maxwell arm at each hinge: τ = -κ·k·(q - z), ż = (q - z)/T.

    k is the hinge's linear stiffness.  The update is exact for a constant speed within the step.
    """

    port = "body.hinge_torque"
    reads = {"angle": "hinge.angle", "speed": "hinge.speed", "stiffness": "hinge.stiffness"}
    state = {"relaxed": 0.0}
    free = ("relaxed",)
    neutral = {"share": 0.0}
    traits = {"dissipative"}
    equation = "-κ*stiffness*(angle - relaxed)"
    evolution = {"relaxed": "(angle - relaxed)/T"}
    title = "viscoelastic relaxation of the arm's material"
    signature = "Effort that decays during holds and depends on the rate of the stroke."
    explanation = (
        "The printed material flows a little under load: part of the elastic torque fades within "
        "its relaxation time, and comes back when the arm is bent the other way."
    )
    tell_apart = {
        "capstan_friction": "holds: friction stays put, relaxation decays",
        "stiffness_hardening": "the same stroke at two speeds, with holds",
        "creep": "the length channel in a hold: relaxation leaves it alone",
        "winding_heating": "a hold without load before it: heat climbs, relaxation decays",
    }
    needs = "holds, or the same stroke at two speeds"
    references = ("Christensen, Theory of Viscoelasticity (1982)",)

    share: float = bounded(0.15, 0.0, 2.0, "1", "κ", "relaxing stiffness over the linear one")
    time: float = bounded(0.5, 0.02, 20.0, "s", "T", "relaxation time", log=True)

    @staticmethod
    def kernel(angle, speed, stiffness, relaxed, share, time, dt):
        """Torque at the hinge [N·m] and the next relaxed angle [rad]."""
        decay = math.exp(-dt / time)
        lag = speed * time
        before = angle - speed * dt
        relaxed = angle - lag + (relaxed - before + lag) * decay
        return -share * stiffness * (angle - relaxed), relaxed
