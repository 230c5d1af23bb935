"""A known weight that hangs on a line of its own, wound on the drum beside the tendon.

    J = J_w + m r²        τ = -r m g

Winding in lifts it.  The line stays taut while the drum gives way more slowly than the weight would
fall.  Source: the weighing of a motor's torque constant with a hoisted mass, any text on drives.
"""

from spirob.emulator.physics.compiled import SIDES, compiled

GRAVITY = 9.80665  # m/s²
NUMBERS = {"hung_mass": (SIDES,)}  # m [kg]
STATE: dict[str, tuple[int, ...]] = {}
SCRATCH: dict[str, tuple[int, ...]] = {}


@compiled
def hung(p, w, m):
    """What the weight adds to the winch's inertia [kg·m²], and its torque [N·m]."""
    lever = w.radius[m] * p.hung_mass[m]
    return w.radius[m] * lever, -GRAVITY * lever
