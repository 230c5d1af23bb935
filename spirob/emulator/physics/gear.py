"""The gear between rotor and winch: a spring that may be soft, and may have play.

    x = twist - clip(twist, -φ, φ)       twist = θ/G - Θ
    τ_g = k_g x (1 + a x²) + c_g ẋ       nothing at all inside the play ±φ

With k_g = 600 N·m/rad it is stiff against any tendon; with 2 N·m/rad, a rubber coupling, it is as
soft as a soft tendon.  A tendon that is never slack keeps its gear on one flank, so play is felt
only where tension is lost.  Source: dead zone of Nordin, Gutman 2002; cubic rubber, assumed.
"""

from spirob.emulator.physics.compiled import SIDES, compiled

GAP_DAMPING = 1e-2  # of c_g: oil between the flanks
NUMBERS = {
    "gear_ratio": (),  # G
    "gear_stiffness": (SIDES,),  # k_g, at the winch [N·m/rad]
    "gear_damping": (SIDES,),  # c_g [N·m·s/rad]
    "gear_hardening": (SIDES,),  # a [1/rad²]
    "gear_play": (SIDES,),  # φ, half the gap, at the winch [rad]
}
STATE = {"gear_torque": (SIDES,)}  # τ_g, at the winch [N·m]
SCRATCH: dict[str, tuple[int, ...]] = {}


@compiled
def gear(p, s, m):
    """Elastic torque of the gear, its slope and its damping, as it is twisted now."""
    twist = (s.rotor_angle[m] - s.rotor_start[m]) / p.gear_ratio - s.winch_angle[m]
    stiffness, damping = p.gear_stiffness[m], p.gear_damping[m]
    if p.gear_play[m] > 0.0:
        if abs(twist) <= p.gear_play[m]:
            return 0.0, 0.0, GAP_DAMPING * damping
        twist -= p.gear_play[m] if twist > 0.0 else -p.gear_play[m]
    if p.gear_hardening[m] > 0.0:
        harder = p.gear_hardening[m] * twist * twist
        return stiffness * twist * (1.0 + harder), stiffness * (1.0 + 3.0 * harder), damping
    return stiffness * twist, stiffness, damping
