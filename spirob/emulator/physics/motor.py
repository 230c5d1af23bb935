"""Rotor, gearbox and winch: two bodies a side, joined by a stiff gear.

    J_m ω̇ = η k_t i + τ_cog - b_m ω - τ_f - τ_g/G
    J_w Ω̇ = τ_g - r T                 τ_g = k_g (θ/G - Θ) + c_g (ω/G - Ω)

Positive current winds tendon in.  η is constant, as the paper has it; a gear that loses in both
directions is an effect of its own (τ_f with load).  Friction of the rotor is a bristle that bends
over an angle δ and slides at a level that falls with speed (Stribeck) and grows with the torque
that the gear carries,

    τ_f = [T_c + T_x exp(-(ω/ω_s)²) + c|τ_g|/G] z        ż = (ω - |ω| z)/δ

Cogging is a sum of harmonics of the rotor angle θ, the lowest of them per turn of the *winch*
(an eccentric gear).  The winch grows as it winds and may be out of round:
r = r₀ (1 + βΘ/2π + ε sin(Θ + ψ)).

Both speeds and the gear torque are taken at the end of the step (linearly implicit): with
J_m = 5e-6 behind G = 1 or 19 the gear needs no smaller step.
"""

import numpy as np

from spirob.emulator.physics.compiled import SIDES, compiled
from spirob.emulator.physics.drive import torque_constant

HARMONICS = 5
NUMBERS = {
    "gear_ratio": (),  # G
    "efficiency": (SIDES,),  # η
    "rotor_inertia": (SIDES,),  # J_m [kg·m²]
    "rotor_damping": (SIDES,),  # b_m [N·m·s/rad]
    "winch_inertia": (SIDES,),  # J_w [kg·m²]
    "gear_stiffness": (SIDES,),  # k_g, at the winch [N·m/rad]
    "gear_damping": (SIDES,),  # c_g [N·m·s/rad]
    "coulomb": (SIDES,),  # T_c, at the rotor [N·m]
    "breakaway": (SIDES,),  # T_x [N·m]
    "stribeck_speed": (),  # ω_s [rad/s]
    "gear_loss": (SIDES,),  # c [-]
    "bristle_angle": (),  # δ, of the rotor [rad]
    "cogging_torque": (SIDES, HARMONICS),  # amplitude at the rotor [N·m]
    "cogging_order": (SIDES, HARMONICS),  # per rotor turn
    "cogging_phase": (SIDES, HARMONICS),  # [rad]
    "winch_radius": (SIDES,),  # r₀ [m]
    "winch_growth": (SIDES,),  # β, per turn
    "winch_eccentricity": (SIDES,),  # ε
    "winch_phase": (SIDES,),  # ψ [rad]
}
STATE = {
    "rotor_angle": (SIDES,),  # θ, from an arbitrary zero [rad]
    "rotor_start": (SIDES,),  # θ when the trial began [rad]
    "rotor_speed": (SIDES,),  # ω [rad/s]
    "winch_angle": (SIDES,),  # Θ since the arm was straight [rad]
    "winch_speed": (SIDES,),  # Ω [rad/s]
    "gear_torque": (SIDES,),  # τ_g, at the winch [N·m]
    "bristle": (SIDES,),  # z [-]
}
SCRATCH = {
    "radius": (SIDES,),  # r now [m]
    "winch_free": (SIDES,),  # rΩ at the end of the step without tension [m/s]
    "winch_yield": (SIDES,),  # by how much one newton lowers it [m/(N·s)]
    "rotor_free": (SIDES,),  # ω at the end of the step without tension [rad/s]
    "rotor_yield": (SIDES,),
}


@compiled
def friction_level(p, s, m):
    """Torque at which the bristles slide [N·m]."""
    ratio = s.rotor_speed[m] / p.stribeck_speed
    level = p.coulomb[m] + p.breakaway[m] * np.exp(-ratio * ratio)
    return level + p.gear_loss[m] * abs(s.gear_torque[m]) / p.gear_ratio


@compiled
def cogging(p, s, m):
    """Torque of the magnets and of the eccentric gear at the rotor [N·m]."""
    total = 0.0
    for n in range(HARMONICS):
        if p.cogging_torque[m, n] > 0.0:
            angle = p.cogging_order[m, n] * s.rotor_angle[m] + p.cogging_phase[m, n]
            total += p.cogging_torque[m, n] * np.sin(angle)
    return total


@compiled
def motors(p, s, w, h):
    """Speeds at the end of the step without tension, and how they yield to it."""
    for m in range(SIDES):
        turn = s.winch_angle[m]
        wobble = p.winch_eccentricity[m] * np.sin(turn + p.winch_phase[m])
        growth = p.winch_growth[m] * turn / (2.0 * np.pi)
        radius = p.winch_radius[m] * max(1.0 + growth + wobble, 0.3)
        ratio = p.gear_ratio
        speed = s.rotor_speed[m]
        side = 1.0 if speed >= 0.0 else -1.0
        level = friction_level(p, s, m)
        bend = h / p.bristle_angle * max(1.0 - side * s.bristle[m], 0.0)
        torque = p.efficiency[m] * torque_constant(p, s, m) * w.mean_current[m]
        torque += cogging(p, s, m) - level * s.bristle[m]

        twist = (s.rotor_angle[m] - s.rotor_start[m]) / ratio - turn
        stiff = h * p.gear_stiffness[m] + p.gear_damping[m]
        spring = p.gear_stiffness[m] * twist
        rotor = p.rotor_inertia[m] + h * (p.rotor_damping[m] + level * bend)
        rotor += h * stiff / ratio**2
        winch = p.winch_inertia[m] + h * stiff
        cross = h * stiff / ratio
        det = rotor * winch - cross * cross
        push = p.rotor_inertia[m] * speed + h * (torque - spring / ratio)
        pull = p.winch_inertia[m] * s.winch_speed[m] + h * spring
        w.rotor_free[m] = (winch * push + cross * pull) / det
        w.winch_free[m] = radius * (rotor * pull + cross * push) / det
        w.rotor_yield[m] = h * radius * cross / det
        w.winch_yield[m] = h * radius * radius * rotor / det
        w.radius[m] = radius


@compiled
def turn_winches(p, s, w, h):
    """Apply the tensions to the winches and turn them through the step."""
    for m in range(SIDES):
        speed = w.rotor_free[m] - w.rotor_yield[m] * s.tension[m]
        reel = w.winch_free[m] - w.winch_yield[m] * s.tension[m]
        turn = reel / w.radius[m]
        side = 1.0 if speed >= 0.0 else -1.0
        stay = np.exp(-abs(speed) * h / p.bristle_angle)
        s.bristle[m] = side + (s.bristle[m] - side) * stay
        s.rotor_speed[m] = speed
        s.rotor_angle[m] += h * speed
        s.winch_speed[m] = turn
        s.winch_angle[m] += h * turn
        s.wound[m] += h * reel
        twist = (s.rotor_angle[m] - s.rotor_start[m]) / p.gear_ratio - s.winch_angle[m]
        slip = speed / p.gear_ratio - turn
        s.gear_torque[m] = p.gear_stiffness[m] * twist + p.gear_damping[m] * slip
