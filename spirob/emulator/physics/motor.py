"""Rotor, gearbox and winch: two bodies a side, joined by the gear.

    J_m ω̇ = η τ + τ_cog - τ_v - τ_f - τ_g/G           (magnets.py, friction.py)
    J_w Ω̇ = τ_g + τ_x - r T                            (gear.py, winch.py)

Positive current winds tendon in.  η is constant, as the paper has it; a gear that loses with its
load, in one or both directions, is an effect of its own (τ_f).

Both speeds and the gear torque are taken at the end of the step (linearly implicit): with
J_m = 5e-6 behind G = 1 or 19 the gear needs no smaller step.
"""

import numpy as np

from spirob.emulator.physics.compiled import SIDES, compiled
from spirob.emulator.physics.friction import friction_level, viscous
from spirob.emulator.physics.gear import gear
from spirob.emulator.physics.load import hung
from spirob.emulator.physics.magnets import cogging, saturated, torque_constant
from spirob.emulator.physics.winch import drum, outside_torque

NUMBERS = {
    "efficiency": (SIDES,),  # η
    "rotor_inertia": (SIDES,),  # J_m [kg·m²]
}
STATE = {
    "rotor_angle": (SIDES,),  # θ, from an arbitrary zero [rad]
    "rotor_start": (SIDES,),  # θ when the trial began [rad]
    "rotor_speed": (SIDES,),  # ω [rad/s]
}
SCRATCH = {
    "winch_free": (SIDES,),  # rΩ at the end of the step without tension [m/s]
    "winch_yield": (SIDES,),  # by how much one newton lowers it [m/(N·s)]
    "rotor_free": (SIDES,),  # ω at the end of the step without tension [rad/s]
    "rotor_yield": (SIDES,),
}


@compiled
def motors(p, s, w, h):
    """Speeds at the end of the step without tension, and how they yield to it."""
    for m in range(SIDES):
        radius = drum(p, s, w, m)
        ratio = p.gear_ratio
        speed = s.rotor_speed[m]
        side = 1.0 if speed >= 0.0 else -1.0
        level = friction_level(p, s, m)
        bend = h / p.bristle_angle * max(1.0 - side * s.bristle[m], 0.0)
        current = w.mean_current[m]
        torque = p.efficiency[m] * torque_constant(p, s, m) * current * saturated(p, current, m)
        torque += cogging(p, s, m) - level * s.bristle[m]

        spring, slope, damping = gear(p, s, m)
        stiff = h * slope + damping
        rotor = p.rotor_inertia[m] + h * (viscous(p, s, m) + level * bend)
        rotor += h * stiff / ratio**2
        added, weight = hung(p, w, m)
        inertia = p.winch_inertia[m] + added
        winch = inertia + h * stiff
        cross = h * stiff / ratio
        det = rotor * winch - cross * cross
        push = p.rotor_inertia[m] * speed + h * (torque - spring / ratio)
        outside = outside_torque(p, s, w, m) + weight
        pull = inertia * s.winch_speed[m] + h * (spring + outside)
        w.rotor_free[m] = (winch * push + cross * pull) / det
        w.winch_free[m] = radius * (rotor * pull + cross * push) / det
        w.rotor_yield[m] = h * radius * cross / det
        w.winch_yield[m] = h * radius * radius * rotor / det


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
        spring, _, damping = gear(p, s, m)
        slip = speed / p.gear_ratio - turn
        s.gear_torque[m] = spring + damping * slip
