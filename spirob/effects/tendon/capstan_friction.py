"""Friction of the tendon along its guides: each bend takes a share of the tension."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class CapstanFriction(Effect):
    """T_behind = T_before·exp(-μ·|q|·z), dz/dt = (ṡ - |ṡ|·z)/δ.

    s is the tendon's sliding through the guide and z ∈ [-1, 1] the direction in which friction is
    mobilised: it turns round within the presliding length δ (Dahl), which keeps the force
    continuous at reversals.  The update of z is exact for a constant speed within the step.
    """

    port = "tendon.tension_ratio"
    reads = {"sliding": "guide.sliding", "bend": "hinge.angle"}
    state = {"direction": 0.0}
    neutral = {"friction": 0.0}
    traits = {"dissipative", "rate_independent"}
    equation = "upstream*exp(-μ*Abs(bend)*direction)"
    evolution = {"direction": "(sliding - Abs(sliding)*direction)/δ"}
    title = "capstan friction of the tendon along its guides"
    signature = (
        "A loop between winding in and paying out that grows with both the bend and the tension, "
        "and turns round sharply at reversals."
    )
    explanation = (
        "Where the arm bends, the tendon presses on its guides and rubs: each bend takes a share "
        "of the tension, so little of it reaches the tip while winding in, and much of it stays "
        "there while paying out."
    )
    tell_apart = {
        "coulomb_friction": "two bends at the same tension: capstan friction follows the bend",
        "load_dependent_friction": "two bends at the same tension: capstan friction follows it",
        "presliding_friction": "two bends at the same tension: capstan friction follows the bend",
        "joint_viscoelasticity": "the same stroke at two speeds, with holds: friction stays put",
    }
    needs = "reversals at two bends or two loads"
    references = ("Euler-Eytelwein; Dahl, Aerospace Corp. TOR-0158 (1968)",)

    friction: float = bounded(0.05, 0.0, 0.6, "1", "μ", "friction coefficient at the guides")
    presliding: float = bounded(3e-4, 2e-5, 5e-3, "m", "δ", "sliding that turns friction round")

    @staticmethod
    def kernel(upstream, sliding, bend, direction, friction, presliding, dt):
        """Tension ratio behind the guide [-] and the next direction."""
        target = 1.0 if sliding > 0.0 else -1.0
        direction = target + (direction - target) * math.exp(-abs(sliding) * dt / presliding)
        return upstream * math.exp(-friction * abs(bend) * direction), direction
