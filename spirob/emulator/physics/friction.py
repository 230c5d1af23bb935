"""Friction of the rotor and of the gear behind it: bristles, grease and a fan.

A bristle bends over an angle δ and slides at a level that falls with speed (Stribeck) and grows
with the torque that the gear carries,

    τ_f = [T_c + T_x exp(-(ω/ω_s)²) + (c + c_b (1 - z sgn τ_g)/2) |τ_g|/G] z      ż = (ω - |ω| z)/δ

c is lost whichever way the gear turns, c_b only while the load drives it (z against τ_g).  Viscous:

    τ_v = [b_m + b_±/(1 + |ω|/ω_t) + D |ω|^(n-1)] ω

with grease that resists one way more than the other and shears thin, and the drag of a fan.

Sources: Canudas de Wit, Olsson, Åström, Lischinsky 1995 (LuGre); Wang, Kim 2015 (directional
efficiency of gears); Cross 1965 (shear-thinning with exponent 1); n ≈ 2 for churning and fans.
"""

import numpy as np

from spirob.emulator.physics.compiled import SIDES, compiled

NUMBERS = {
    "coulomb": (SIDES,),  # T_c, at the rotor [N·m]
    "breakaway": (SIDES,),  # T_x [N·m]
    "stribeck_speed": (),  # ω_s [rad/s]
    "gear_loss": (SIDES,),  # c [-]
    "back_loss": (SIDES,),  # c_b [-]
    "bristle_angle": (),  # δ, of the rotor [rad]
    "rotor_damping": (SIDES,),  # b_m [N·m·s/rad]
    "grease": (SIDES, 2),  # b_±: winding in, paying out [N·m·s/rad]
    "thinning_speed": (),  # ω_t [rad/s]
    "fan": (SIDES,),  # D [N·m·(s/rad)ⁿ]
    "fan_power": (),  # n [-]
}
STATE = {"bristle": (SIDES,)}  # z [-]
SCRATCH: dict[str, tuple[int, ...]] = {}


@compiled
def friction_level(p, s, m):
    """Torque at which the bristles slide [N·m]."""
    ratio = s.rotor_speed[m] / p.stribeck_speed
    level = p.coulomb[m] + p.breakaway[m] * np.exp(-ratio * ratio)
    load = abs(s.gear_torque[m]) / p.gear_ratio
    level += p.gear_loss[m] * load
    if p.back_loss[m] > 0.0:
        side = 1.0 if s.gear_torque[m] >= 0.0 else -1.0
        level += p.back_loss[m] * load * 0.5 * (1.0 - side * s.bristle[m])
    return level


@compiled
def viscous(p, s, m):
    """Drag torque over speed [N·m·s/rad]."""
    speed = s.rotor_speed[m]
    total = p.rotor_damping[m]
    grease = p.grease[m, 0] if speed >= 0.0 else p.grease[m, 1]
    if grease > 0.0:
        total += grease / (1.0 + abs(speed) / p.thinning_speed)
    if p.fan[m] > 0.0:
        total += p.fan[m] * abs(speed) ** (p.fan_power - 1.0)
    return total
