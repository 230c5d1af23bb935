"""Play between the motor and the drum."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class Backlash(Effect):
    """The drum lags the motor within its play: extra length g, from -(1 - h)·b to h·b.

    Taut, the tendon keeps the drum on one flank (g = h b) and no play is seen.  Slack, the drum
    rests on its own friction F_h while the motor turns through the play, ġ = ẋ·max(0, 1 - F/F_h)
    within the bounds; then the tension pulls it home, ġ = (h b - g)·F/(F_h·t_s), here exact for a
    constant tension.  h is where in its play the drum rests when a trial begins (g = 0).
    """

    port = "tendon.extra_length"
    reads = {"velocity": "winch.velocity", "tension": "tendon.tension"}
    state = {"gap": 0.0}
    neutral = {"play": 0.0}
    equation = "gap"
    title = "backlash of the gear"
    signature = "A step in length, without effort, wherever the load lets go or takes hold again."
    explanation = (
        "Gear teeth leave a gap: when the load changes sides the motor turns through it before the "
        "drum follows.  While the tendon stays taut nothing of it is seen."
    )
    tell_apart = {
        "presliding_friction": "stay taut: play then disappears, friction does not",
        "stretch": "stay taut: play then disappears, elasticity does not",
        "gear_compliance": "stay taut: play then disappears, elasticity does not",
    }
    needs = "a tendon that goes slack and taut again"
    references = ("Nordin, Gutman, Automatica 38 (2002)",)

    play: float = bounded(1e-3, 0.0, 0.01, "m", "b", "play at the drum's surface")
    rest: float = bounded(0.5, 0.0, 1.0, "1", "h", "share of it to take up at the start")
    hold: float = bounded(0.5, 0.05, 10.0, "N", "F_h", "tension that pulls the drum home")
    seating: float = bounded(0.01, 2e-3, 0.1, "s", "t_s", "time in which it does")

    @staticmethod
    def kernel(velocity, tension, gap, play, rest, hold, seating, dt):
        """Length that the tendon has gained [m], and the next gap [m]."""
        resting = max(0.0, 1.0 - tension / hold)
        home = rest * play
        gap = min(home, max(home - play, gap + velocity * resting * dt))
        gap = home + (gap - home) * math.exp(-max(tension, 0.0) * dt / (hold * seating))
        return gap, gap
