"""From current to tendon: magnets, friction, gear, drum, a weight, and the bodies they turn.

The magnets make of a current the torque

    τ = k_t i / (1 + (|i|/i_s)ⁿ)^(1/n)
    k_t = k_t0 (1 + Σ ρ_j sin(ν_j θ + ψ_j)) / (1 + α_B ϑ)

The ripple ρ belongs to flux, thus to torque and back-EMF alike; the iron saturates over i_s, and
warm magnets (ϑ above the room) are weaker.  Cogging is torque without current, a sum of harmonics
of the rotor angle θ, the lowest of them per turn of the *winch* (an eccentric gear).

Sources: Hanselman, "Brushless Permanent Magnet Motor Design" (ripple, cogging); Fröhlich's curve
with a free knee for saturation; magnet data sheets, which are linear in temperature to first order
(the reciprocal agrees to that order and stays positive in a stalled motor).

Rotor and gear rub by bristles, grease and a fan.  A bristle bends over an angle δ and slides at a
level that falls with speed (Stribeck) and grows with the torque that the gear carries,

    τ_f = [T_c + T_x exp(-(ω/ω_s)²) + (c + c_b (1 - z sgn τ_g)/2) |τ_g|/G + T_s S(Θ)] z
    ż = (ω - |ω| z)/δ        S = exp(-2 (sin((Θ - Θ_s)/2)/w_s)²)

S is a tight spot in the turn of the winch.  c is lost whichever way the gear turns, c_b only while
the load drives it (z against τ_g).  Viscous:

    τ_v = [b_m + b_±/(1 + |ω|/ω_t) + D |ω|^(n-1)] ω

with grease that resists one way more than the other and shears thin, and the drag of a fan.

Sources: Canudas de Wit, Olsson, Åström, Lischinsky 1995 (LuGre); Wang, Kim 2015 (directional
efficiency of gears); Cross 1965 (shear-thinning with exponent 1); n ≈ 2 for churning and fans.

The gear between rotor and winch is a spring that may be soft and may have play,

    x = twist - clip(twist, -φ, φ)       twist = θ/G - Θ
    τ_g = k_g x (1 + a x²) + c_g ẋ       nothing at all inside the play ±φ

With k_g = 600 N·m/rad it is stiff against any tendon; with 2 N·m/rad, a rubber coupling, it is as
soft as a soft tendon.  A tendon that is never slack keeps its gear on one flank, so play is felt
only where tension is lost.  Source: dead zone of Nordin, Gutman 2002; cubic rubber, assumed.

The drum that a tendon winds on has the radius r and carries the torque

    r = r₀ (1 + βΘ/2π + ε sin(Θ + ψ) + ε₂ sin(2Θ + ψ₂))       τ_x = r (P - k_P x)

The drum grows as it winds (β), may be out of centre (ε) and oval (ε₂).  P and k_P are a spring or
weight outside the robot that pulls at the line beside the tendon, positive winding in; x is the
length wound in.

A known weight hangs on a line of its own, wound on the drum beside the tendon:

    J = J_w + m r²        τ = -r m g

Winding in lifts it.  The line stays taut while the drum gives way more slowly than the weight would
fall.  Source: the weighing of a motor's torque constant with a hoisted mass, any text on drives.

Rotor and winch are two bodies a side, joined by the gear.

    J_m ω̇ = η τ + τ_cog - τ_v - τ_f - τ_g/G
    J_w Ω̇ = τ_g + τ_x - r T

Positive current winds tendon in.  η is constant, as the paper has it; a gear that loses with its
load, in one or both directions, is an effect of its own (τ_f).

Both speeds and the gear torque are taken at the end of the step (linearly implicit): with
J_m = 5e-6 behind G = 1 or 19 the gear needs no smaller step.
"""

import numpy as np

from spirob.emulator.physics import SIDES, compiled

HARMONICS = 5
GAP_DAMPING = 1e-2  # of c_g: oil between the flanks
GRAVITY = 9.80665  # m/s²
NUMBERS = {
    "torque_constant": (SIDES,),  # k_t0 = k_e [N·m/A]
    "magnet_heating": (),  # α_B [1/K]
    "ripple": (SIDES, HARMONICS),  # ρ [-]
    "ripple_order": (SIDES, HARMONICS),  # ν, per rotor turn
    "ripple_phase": (SIDES, HARMONICS),  # ψ [rad]
    "saturation": (SIDES,),  # 1/i_s [1/A]
    "saturation_power": (),  # n [-]
    "cogging_torque": (SIDES, HARMONICS),  # amplitude at the rotor [N·m]
    "cogging_order": (SIDES, HARMONICS),  # per rotor turn
    "cogging_phase": (SIDES, HARMONICS),  # [rad]
    "coulomb": (SIDES,),  # T_c, at the rotor [N·m]
    "breakaway": (SIDES,),  # T_x [N·m]
    "stribeck_speed": (),  # ω_s [rad/s]
    "gear_loss": (SIDES,),  # c [-]
    "back_loss": (SIDES,),  # c_b [-]
    "tight": (SIDES,),  # T_s, in the middle of a tight spot of the winch's turn [N·m]
    "tight_angle": (SIDES,),  # Θ_s, where it is [rad]
    "tight_width": (),  # w_s, its half width [rad]
    "bristle_angle": (),  # δ, of the rotor [rad]
    "rotor_damping": (SIDES,),  # b_m [N·m·s/rad]
    "grease": (SIDES, 2),  # b_±: winding in, paying out [N·m·s/rad]
    "thinning_speed": (),  # ω_t [rad/s]
    "fan": (SIDES,),  # D [N·m·(s/rad)ⁿ]
    "fan_power": (),  # n [-]
    "gear_ratio": (),  # G
    "gear_stiffness": (SIDES,),  # k_g, at the winch [N·m/rad]
    "gear_damping": (SIDES,),  # c_g [N·m·s/rad]
    "gear_hardening": (SIDES,),  # a [1/rad²]
    "gear_play": (SIDES,),  # φ, half the gap, at the winch [rad]
    "winch_inertia": (SIDES,),  # J_w [kg·m²]
    "winch_radius": (SIDES,),  # r₀ [m]
    "winch_growth": (SIDES,),  # β, per turn
    "winch_eccentricity": (SIDES,),  # ε
    "winch_phase": (SIDES,),  # ψ [rad]
    "winch_oval": (SIDES,),  # ε₂
    "winch_oval_phase": (SIDES,),  # ψ₂ [rad]
    "outside_pull": (SIDES,),  # P [N]
    "outside_stiffness": (SIDES,),  # k_P [N/m]
    "hung_mass": (SIDES,),  # m [kg]
    "efficiency": (SIDES,),  # η
    "rotor_inertia": (SIDES,),  # J_m [kg·m²]
}
STATE = {
    "warmth": (SIDES,),  # ϑ, of the winding and its magnets above the room [K]
    "bristle": (SIDES,),  # z [-]
    "gear_torque": (SIDES,),  # τ_g, at the winch [N·m]
    "winch_angle": (SIDES,),  # Θ since the arm was straight [rad]
    "winch_speed": (SIDES,),  # Ω [rad/s]
    "rotor_angle": (SIDES,),  # θ, from an arbitrary zero [rad]
    "rotor_start": (SIDES,),  # θ when the trial began [rad]
    "rotor_speed": (SIDES,),  # ω [rad/s]
}
SCRATCH = {
    "radius": (SIDES,),  # r now [m]
    "winch_free": (SIDES,),  # rΩ at the end of the step without tension [m/s]
    "winch_yield": (SIDES,),  # by how much one newton lowers it [m/(N·s)]
    "rotor_free": (SIDES,),  # ω at the end of the step without tension [rad/s]
    "rotor_yield": (SIDES,),
}


@compiled
def torque_constant(p, s, m):
    """k_t of the magnets as warm as they are, where the rotor stands [N·m/A]."""
    flux = p.torque_constant[m] / (1.0 + p.magnet_heating * s.warmth[m])
    ripple = 0.0
    for n in range(HARMONICS):
        if p.ripple[m, n] > 0.0:
            angle = p.ripple_order[m, n] * s.rotor_angle[m] + p.ripple_phase[m, n]
            ripple += p.ripple[m, n] * np.sin(angle)
    return flux * (1.0 + ripple)


@compiled
def saturated(p, current, m):
    """The share of its torque that a current keeps in iron that saturates [-]."""
    if p.saturation[m] <= 0.0:
        return 1.0
    n = p.saturation_power
    return (1.0 + (abs(current) * p.saturation[m]) ** n) ** (-1.0 / n)


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
def friction_level(p, s, m):
    """Torque at which the bristles slide [N·m]."""
    ratio = s.rotor_speed[m] / p.stribeck_speed
    level = p.coulomb[m] + p.breakaway[m] * np.exp(-ratio * ratio)
    load = abs(s.gear_torque[m]) / p.gear_ratio
    level += p.gear_loss[m] * load
    if p.back_loss[m] > 0.0:
        side = 1.0 if s.gear_torque[m] >= 0.0 else -1.0
        level += p.back_loss[m] * load * 0.5 * (1.0 - side * s.bristle[m])
    if p.tight[m] > 0.0:
        away = np.sin(0.5 * (s.winch_angle[m] - p.tight_angle[m])) / p.tight_width
        level += p.tight[m] * np.exp(-2.0 * away * away)
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


@compiled
def drum(p, s, w, m):
    """Measure the drum's radius as it is wound now [m]."""
    turn = s.winch_angle[m]
    wobble = p.winch_eccentricity[m] * np.sin(turn + p.winch_phase[m])
    if p.winch_oval[m] > 0.0:
        wobble += p.winch_oval[m] * np.sin(2.0 * turn + p.winch_oval_phase[m])
    growth = p.winch_growth[m] * turn / (2.0 * np.pi)
    w.radius[m] = p.winch_radius[m] * max(1.0 + growth + wobble, 0.3)
    return w.radius[m]


@compiled
def outside_torque(p, s, w, m):
    """Torque on the winch from outside the robot, positive winding in [N·m]."""
    return w.radius[m] * (p.outside_pull[m] - p.outside_stiffness[m] * s.wound[m])


@compiled
def hung(p, w, m):
    """What the weight adds to the winch's inertia [kg·m²], and its torque [N·m]."""
    lever = w.radius[m] * p.hung_mass[m]
    return w.radius[m] * lever, -GRAVITY * lever


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
