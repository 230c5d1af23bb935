# ruff: noqa: F821
"""The three steps of the cycle, as templates whose ports `plant.assemble` fills in (see `loop`).

j_a  drive and R-L circuit: command, or the host's voltage -> i*
j_b  i* -> torque at the drum
j_c  rotors, tendons and arm together -> F, Δl, dΔl/dt
"""


def j_a(p, s, w, c, laws, m):
    """Drive and R-L circuit: from the command, or the host's voltage, to the current i*."""
    radius = own(p.winch.radius, p.winch.radius_difference, m)
    # @ port winch.radius -> radius
    s.radius[m] = radius
    rotor_speed = p.winch.gear_ratio * s.rate[m] / radius
    supply = p.drive.voltage_limit
    # @ port motor.supply -> supply
    resistance = p.motor.resistance
    # @ port motor.resistance -> resistance
    disturbance = 0.0
    # @ port motor.voltage -> disturbance
    if HOST_LOOP:
        whole = int(c.host_latency)  # cycles from a reading until its voltage acts
        switch = (c.host_latency - whole) * c.cycle  # and the rest, into a cycle [s]
        s.current[m], w.mean_current[m] = held_current(
            s.current[m],
            s.volts[whole + 1, m],
            s.volts[whole, m],
            min(max(switch - w.substep * c.step, 0.0), c.step),
            c.step,
            p.motor.emf_constant * rotor_speed,
            disturbance,
            resistance,
            p.motor.inductance,
            supply,
        )
    else:
        gain_p, gain_i = current_loop_gains(
            p.motor.resistance, p.motor.inductance, p.drive.bandwidth
        )
        s.current[m], s.integral[m], w.mean_current[m] = drive_current(
            s.current[m],
            s.integral[m],
            s.command[m],
            (s.command[m] - w.command_before[m]) / c.cycle,
            w.misread[m],
            p.motor.emf_constant * rotor_speed,
            disturbance,
            c.drive_steps,
            c.step / c.drive_steps,
            resistance,
            p.motor.inductance,
            gain_p,
            gain_i,
            p.drive.emf_compensation,
            supply,
        )


def j_b(p, s, w, c, laws, m):
    """From the current to the torque at the drum, τ = ηG k_t i* and what effects add."""
    drive_torque = p.motor.torque_constant * w.mean_current[m]
    # @ port motor.drive_torque -> drive_torque
    # torque at this speed and just above it: its slope is solved implicitly
    slope = 0.0
    added = 0.0
    for probe in range(1, -1, -1):
        rotor_speed = p.winch.gear_ratio * s.rate[m] / s.radius[m] + 0.01 * probe
        efficiency = own(p.winch.efficiency, p.winch.efficiency_difference, m)
        # @ probe winch.efficiency -> efficiency
        added = efficiency * drive_torque
        # @ probe motor.torque -> added
        slope = added if probe == 1 else (added - slope) / 0.01
    damping = max(0.0, slope)
    w.rotor_damping[m] = damping
    gear = p.winch.gear_ratio
    w.torque[m] = gear * (added + damping * gear * s.rate[m] / s.radius[m])


def j_c(p, s, w, c, arm, moved, laws):
    """Rotors, tendons and arm together: tensions, what is wound in, torques at the hinges.

    It returns whether the arm touches nothing, so that `body_moves` takes the planar chain.
    """
    untouched = body_begins(arm, moved)
    mobility(p, s, w, c, arm, moved, laws, untouched)
    for m in range(2):
        free_rotor(p, s, w, c, laws, m)
    s.tension[0], s.tension[1] = one_sided_tensions(
        w.demand[0],
        w.demand[1],
        1.0 + w.give[0] * (1.0 / w.weight[0] + w.mobility[0, 0]),
        w.give[0] * w.mobility[0, 1],
        w.give[1] * w.mobility[1, 0],
        1.0 + w.give[1] * (1.0 / w.weight[1] + w.mobility[1, 1]),
    )
    for m in range(2):
        s.rate_before[m] = s.shortening_rate[m]
        s.pulled[m] = w.mobility[m, 0] * s.tension[0] + w.mobility[m, 1] * s.tension[1]
        s.rate[m] = w.free_rate[m] - c.step * s.tension[m] / w.weight[m]
        s.displacement[m] += c.step * s.rate[m]
        s.turned[m] += c.step * s.rate[m] / s.radius[m]
    hinge_torques(p, s, w, c, arm, moved, laws)
    return untouched


def mobility(p, s, w, c, arm, moved, laws, untouched):
    """A = J M⁻¹ Jᵀ, what both tensions do to both lengths, with what friction leaves of them."""
    hinges = arm.guides.shape[1]
    for m in range(2):
        slide = s.shortening_rate[m]
        ratio = 1.0
        for i in range(hinges):
            # the tendon ahead of guide i has already taken up what lies nearer the base
            # @ port tendon.tension_ratio -> ratio
            arm.pull[m, i] = ratio * arm.lever[m, i]
            slide -= arm.lever[m, i] * moved.qvel[i]
    body_yields(arm, moved, untouched)
    for m in range(2):
        for n in range(2):
            total = 0.0
            for i in range(hinges):
                total += arm.lever[n, i] * arm.solved[m, i]
            w.mobility[n, m] = total


def free_rotor(p, s, w, c, laws, m):
    """A rotor without its tendon, and the tension that it would ask of an arm that stood still."""
    gear, radius = p.winch.gear_ratio, s.radius[m]
    inertia = own(p.motor.rotor_inertia, p.motor.rotor_inertia_difference, m)
    inertia = (gear * gear * inertia + p.winch.drum_inertia) / (radius * radius) + s.hung[m]
    damping = own(p.motor.rotor_damping, p.motor.rotor_damping_difference, m)
    damping = gear * gear * (damping + w.rotor_damping[m]) / (radius * radius)
    external = -9.80665 * s.hung[m]  # standard gravity [m/s²]
    # @ port tendon.force -> external
    extra = 0.0
    # @ port tendon.extra_length -> extra
    s.extra_length[m] = extra
    elasticity = p.tendon.stiffness
    # @ port tendon.stiffness -> elasticity
    share = elasticity / p.tendon.stiffness
    tendon_damping = max(p.tendon.damping, c.step * p.tendon.stiffness)
    w.give[m] = c.step * share * tendon_damping
    w.weight[m] = inertia + c.step * damping
    w.free_rate[m] = free_rate(s.rate[m], w.torque[m] / radius + external, inertia, damping, c.step)
    if s.cycle + w.substep > 0:
        seen = (s.shortening_rate[m] - s.rate_before[m]) / c.step
        s.unpulled[m] += 0.3 * (seen - s.pulled[m] - s.unpulled[m])
    w.demand[m] = demanded_tension(
        s.displacement[m] - s.shortening[m] - extra,
        w.free_rate[m],
        s.shortening_rate[m],
        s.unpulled[m],
        elasticity,
        share * tendon_damping,
        c.step,
    )


def hinge_torques(p, s, w, c, arm, moved, laws):
    """What tensions and effects put on the hinges, where MuJoCo reads it."""
    if READS_hinge_weight:
        hinge_weights(moved.qpos, arm.units, arm.hinge_weight)
    for i in range(arm.guides.shape[1]):
        hinge_torque = 0.0
        # @ port body.hinge_torque -> hinge_torque
        pulled = hinge_torque + s.tension[0] * arm.pull[0, i]
        moved.applied[i] = pulled + s.tension[1] * arm.pull[1, i]


def body_begins(arm, moved):
    """Begin a step of the arm; returns whether it touches nothing."""
    if arm.alone and is_free(moved.qpos, arm.chain, arm.post, arm.place):
        chain_factor(arm.chain, arm.place, 0.0, arm.factor)
        return True
    if arm.bows[0] > 0.0:
        bend_outline(moved.qpos, arm.bows, arm.heights, arm.outline, moved.positions)
    mj_step1(moved.model, moved.data)
    return False


def body_yields(arm, moved, untouched):
    """How the arm yields to each tendon: solved = M⁻¹ pull."""
    if untouched:
        for m in range(2):
            chain_solve(arm.place, arm.factor, arm.pull[m], arm.solved[m])
    else:
        for m in range(2):
            mj_solveM(moved.model, moved.data, moved.solved[m], moved.pull[m], 1)


def body_moves(c, arm, moved, untouched):
    """End a step of the arm under the torques at its hinges."""
    if untouched:
        chain_step(
            moved.qpos,
            moved.qvel,
            moved.applied,
            arm.chain,
            arm.place,
            arm.gravity,
            c.step,
            arm.factor,
            arm.work,
        )
    else:
        mj_step2(moved.model, moved.data)
