"""Play between the motor and its load."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class Backlash(Effect):
    """τ = J_l·(ω' + ω/T) while the load is loose, -J_l·(ω - ω_l)/Δt where a flank catches it.

    In contact the load moves with the motor, as the rigid model has it.  It comes loose where the
    flank would have to pull, coasts, ω_l' = -ω_l/T, and is caught at the other flank of the play
    without a rebound.
    """

    port = "motor.torque"
    reads = {"speed": "motor.speed"}
    state = {"gap": 0.0, "loose": 0.0, "last": 0.0, "seen": 0.0}
    neutral = {"load_inertia": 0.0}
    title = "backlash between motor and load"
    signature = "A moment of ease when the effort changes sides, then a blow."
    explanation = (
        "Teeth leave a gap: when the load changes sides the motor runs through it alone, and "
        "catches the load at the other flank."
    )
    tell_apart = {
        "gear_compliance": "small and large motions: a spring's share is the same, play's is not",
        "presliding_friction": "a steady load on one side: play disappears, friction does not",
        "coulomb_friction": "a steady load on one side: play disappears, friction does not",
    }
    needs = "an effort that changes sides, with a load that can be accelerated"
    references = ("Nordin, Gutman, Automatica 38 (2002)",)

    load_inertia: float = bounded(4e-5, 0.0, 4e-3, "N·m·s²/rad", "J_l", "inertia behind the play")
    play: float = bounded(0.05, 1e-4, 10.0, "rad", "b", "way from flank to flank", log=True)
    coasting: float = bounded(
        0.3, 0.01, 10.0, "s", "T", "time in which the loose load comes to rest", log=True
    )

    @staticmethod
    def kernel(speed, gap, loose, last, seen, load_inertia, play, coasting, dt):
        """Torque on the motor [N·m]; next gap [rad, ± half the play in contact] and speeds."""
        if seen == 0.0:
            side = 1.0 if speed >= 0.0 else -1.0
            return 0.0, side * play / 2.0, speed, speed, 1.0
        pulled = (speed - last) / dt + speed / coasting
        in_contact = abs(gap) >= play / 2.0
        if in_contact and pulled * gap >= 0.0:
            return 0.0, gap, speed, speed, 1.0
        coasted = loose * math.exp(-dt / coasting)
        gap += 0.5 * dt * (speed + last - coasted - loose)
        torque = load_inertia * pulled
        if abs(gap) >= play / 2.0:
            gap = math.copysign(play / 2.0, gap)
            if (speed - coasted) * gap > 0.0:
                torque -= load_inertia * (speed - coasted) / dt
                coasted = speed
        return torque, gap, coasted, speed, 1.0
