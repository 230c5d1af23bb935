# ruff: noqa: F821
"""The coupled cycle, as a template: `plant.assemble` fills in the ports and compiles it.

A comment `# @ port name -> variable` is replaced by one statement for each effect at that port;
`repeat` applies them to another signal, `probe` asks them at another speed.  `READS_...` is whether
an effect reads a signal.
`P_...` are positions in the parameter vector, `HOST_LOOP` is whether the host closes the current
loop, by voltages that it holds for a cycle, or the drive.  What the loop does in cycle k:

    j_a  feedback law -> i_cmd;  drive and R-L circuit -> i*            (control.law, electrics)
    j_b  i* -> torque at the drum                                       (here)
    j_c  rotor, tendon and arm together -> F, Δl, dΔl/dt; i**           (winch, MuJoCo)

repeated j_b, j_c for each substep.  Row k of the output is the state at the start of the cycle,
as the drive reports it, with the command that follows from it;
one more row holds the state after the last cycle.

    i** = (J_eq Δl̈/r + b_eq Δl̇/r + r F + r m (g + Δl̈) - G τ_effects)/(η G k_t)

with m a weight on the drum, where the scene hangs one there.

It is written as i* plus the difference between the arm's motion and the rotor's, which is the same
equation (the rotor satisfies it with i*) and holds with every effect; a slack tendon tells the
rotor nothing of the arm, and there i** = i*.
"""


def run(
    model,
    data,
    qpos,
    qvel,
    applied,
    p,
    mode,
    reference,
    reference_rate,
    limit,
    gains,
    guides,
    units,
    bows,
    heights,
    outline,
    positions,
    chain,
    post,
    gravity,
    stiffness,
    substeps,
    step,
    drive_steps,
    state,
    memory,
    pull,
    pull_address,
    solved,
    solved_address,
    out,
    angles,
):
    """Simulate all cycles; returns the cycle where a state became non-finite, or -1.

    guides (5, N) holds ρ_b·ρ_a, (ρ_b - ρ_a)², sin β/2n, cos β/2n, n of each hinge (`plant.tendon`);
    units (N + 1, 2) mass [kg] and length [m] of each unit, and the mass at the tip;
    bows, heights, outline, positions move the units' outlines (`plant.objects`);
    chain holds the units' numbers for steps in which nothing is touched (`plant.chain`), no
    column where something else moves; post (3,) a fixed cylinder; gravity (2,) [m/s²];
    pull (2, N) is the shortening of each tendon per hinge angle weighted with the local tension
    ratio, solved (2, N) what `mj_solveM` makes of it; C wants their addresses too.
    """
    cycles = reference.shape[0]
    motors = 2
    hinges = guides.shape[1]
    dt = step
    cycle_time = substeps * step
    gear = p[P_winch_gear_ratio]
    nominal_radius = gains[7]
    gain_p, gain_i = current_loop_gains(
        p[P_motor_resistance], p[P_motor_inductance], p[P_drive_bandwidth]
    )
    side = np.array([1.0, -1.0])
    rest, tendon_work = np.zeros(hinges), np.zeros((3, hinges))
    arm = np.zeros((motors, hinges))  # shortening of each tendon per hinge angle
    # what a motor remembers from cycle to cycle, one row each
    current, integral, velocity_integral = state[0], state[1], state[2]
    displacement, rate, turned = state[3], state[4], state[5]  # x, w, angle of the drum
    tension, shortening, shortening_rate = state[6], state[7], state[8]  # F, Δl, dΔl/dt
    previous_rate, previous_accel, arm_accel = state[9], state[10], state[11]
    command, arm_current, radius_now = state[12], state[13], state[14]
    begun = state[15]  # cycles played so far, in its first entry
    reading_error = state[16]  # of the reported length [m]; its rate is that of the velocity
    extra_length = state[17]  # by which the tendon has grown [m]
    first_angle = state[18]  # of the rotor when the trial began [rad]
    hung = state[19]  # mass on a line of its own beside each tendon [kg]
    reading_zero = state[20]  # reading error where the trial began [m]: lengths count from there
    if HOST_LOOP:
        # voltages of this cycle and the two before [V], integral [V] and error [A] of (13)
        volts, host_integral, host_error = state[21:24], state[24], state[25]
        whole = int(gains[15])  # cycles from a reading until its voltage acts
        switch = (gains[15] - whole) * cycle_time  # and the rest, into a cycle [s]
    mobility = np.zeros((motors, motors))  # A = J M⁻¹ Jᵀ [1/kg]
    weight = np.zeros(motors)  # m + h b [kg]
    demand = np.zeros(motors)
    free = np.zeros(motors)
    give = np.zeros(motors)
    tendon_damping = max(p[P_tendon_damping], step * p[P_tendon_stiffness])
    hinge_weight = np.zeros((hinges, 2))  # N·m, by direction of gravity
    place, factor, work = np.zeros((8, hinges)), np.zeros((4, hinges)), np.zeros((2, hinges))
    alone = chain.shape[1] > 0
    mean_current = np.zeros(motors)
    misread = np.zeros(motors)  # what the current sensor says less the current [A]
    last_command = np.zeros(motors)
    if begun[0] == 0.0:
        radius_now[:] = p[P_winch_radius] * (1.0 + side * p[P_winch_radius_difference])
    for i in range(hinges):
        rest[i], _ = guide_length(
            1.0, 0.0, 1.0, guides[0, i], guides[1, i], guides[2, i], guides[3, i], guides[4, i]
        )
    pose_tendons(qpos, qvel, guides, rest, arm, shortening, shortening_rate, tendon_work)
    for cycle in range(cycles + 1):
        time = begun[0] * cycle_time
        for m in range(motors):
            # what the drive reports
            sensed_displacement = nominal_radius * turned[m]
            # @ port sensing.displacement -> sensed_displacement
            if begun[0] == 0.0:
                reading_zero[m] = sensed_displacement - nominal_radius * turned[m]
            sensed_displacement -= reading_zero[m]
            # @ port sensing.frame -> sensed_displacement
            # the drive differentiates the length that it reports
            error = sensed_displacement - nominal_radius * turned[m]
            sensed_velocity = nominal_radius * rate[m] / radius_now[m]
            sensed_velocity += (error - reading_error[m]) / cycle_time
            if cycle < cycles:
                reading_error[m] = error
            sensed_current = current[m]
            # @ port sensing.current -> sensed_current
            misread[m] = sensed_current - current[m]
            # @ port sensing.report -> sensed_current
            # @ repeat sensing.frame -> sensed_current
            sensed_arm_current = arm_current[m]
            # @ repeat sensing.current -> sensed_arm_current
            # @ repeat sensing.report -> sensed_arm_current
            # @ repeat sensing.frame -> sensed_arm_current
            out[cycle, m, 0] = sensed_current
            out[cycle, m, 1] = sensed_arm_current
            out[cycle, m, 2] = sensed_displacement
            out[cycle, m, 3] = sensed_velocity
            out[cycle, m, 4] = shortening[m]
            out[cycle, m, 5] = shortening_rate[m]
            out[cycle, m, 6] = tension[m]
            if cycle == cycles:
                continue
            last_command[m] = command[m]
            wanted, velocity_integral[m] = current_command(
                mode[m],
                reference[cycle, m],
                reference_rate[cycle, m],
                sensed_displacement,
                sensed_velocity,
                sensed_current,
                velocity_integral[m],
                cycle_time,
                limit[m],
                gains[0],
                gains[1],
                gains[2],
                gains[3],
                gains[4],
                gains[5],
            )
            # @ port command.current -> wanted
            command[m] = wanted
            out[cycle, m, 7] = wanted
            if HOST_LOOP:
                if begun[0] == 0.0:
                    host_error[m] = wanted - sensed_current
                volts[2, m], volts[1, m] = volts[1, m], volts[0, m]
                volts[0, m], host_integral[m], host_error[m] = host_voltage(
                    wanted,
                    last_command[m],
                    sensed_current,
                    host_error[m],
                    gear * sensed_velocity / nominal_radius,
                    host_integral[m],
                    cycle_time,
                    gains[8],
                    gains[9],
                    gains[10],
                    gains[11],
                    gains[12],
                    gains[13],
                    gains[14],
                )
                volts[0, m] = gains[16] * np.rint(volts[0, m] / gains[16])  # counts on the bus
                out[cycle, m, 8] = volts[0, m]
        for i in range(hinges):
            angles[cycle, i] = qpos[i]
        if cycle == cycles:
            break
        rate_before = rate.copy()
        arm_rate_before = shortening_rate.copy()
        for substep in range(substeps):
            untouched = alone and is_free(qpos, chain, post, place)
            if untouched:
                chain_factor(chain, place, 0.0, factor)
            else:
                if bows[0] > 0.0:
                    bend_outline(qpos, bows, heights, outline, positions)
                mj_step1(model, data)
            for m in range(motors):
                slide = shortening_rate[m]
                ratio = 1.0
                for i in range(hinges):
                    # the tendon ahead of guide i has already taken up what lies nearer the base
                    # @ port tendon.tension_ratio -> ratio
                    pull[m, i] = ratio * arm[m, i]
                    slide -= arm[m, i] * qvel[i]
            if untouched:
                for m in range(motors):
                    chain_solve(place, factor, pull[m], solved[m])
            else:
                mj_solveM(model, data, solved_address, pull_address, motors)
            for m in range(motors):
                for n in range(motors):
                    total = 0.0
                    for i in range(hinges):
                        total += arm[n, i] * solved[m, i]
                    mobility[n, m] = total
            for m in range(motors):
                radius = p[P_winch_radius] * (1.0 + side[m] * p[P_winch_radius_difference])
                # @ port winch.radius -> radius
                radius_now[m] = radius
                rotor_speed = gear * rate[m] / radius
                supply = p[P_drive_voltage_limit]
                # @ port motor.supply -> supply
                resistance = p[P_motor_resistance]
                # @ port motor.resistance -> resistance
                disturbance = 0.0
                # @ port motor.voltage -> disturbance
                if HOST_LOOP:
                    current[m], mean_current[m] = held_current(
                        current[m],
                        volts[whole + 1, m],
                        volts[whole, m],
                        min(max(switch - substep * step, 0.0), step),
                        step,
                        p[P_motor_emf_constant] * rotor_speed,
                        disturbance,
                        resistance,
                        p[P_motor_inductance],
                        supply,
                    )
                else:
                    current[m], integral[m], mean_current[m] = drive_current(
                        current[m],
                        integral[m],
                        command[m],
                        (command[m] - last_command[m]) / cycle_time,
                        misread[m],
                        p[P_motor_emf_constant] * rotor_speed,
                        disturbance,
                        drive_steps,
                        step / drive_steps,
                        resistance,
                        p[P_motor_inductance],
                        gain_p,
                        gain_i,
                        p[P_drive_emf_compensation],
                        supply,
                    )
                drive_torque = p[P_motor_torque_constant] * mean_current[m]
                # @ port motor.drive_torque -> drive_torque
                # torque at this speed and just above it: its slope is solved implicitly
                slope = 0.0
                added = 0.0
                for probe in range(1, -1, -1):
                    rotor_speed = gear * rate[m] / radius + 0.01 * probe
                    efficiency = p[P_winch_efficiency]
                    efficiency *= 1.0 + side[m] * p[P_winch_efficiency_difference]
                    # @ probe winch.efficiency -> efficiency
                    added = efficiency * drive_torque
                    # @ probe motor.torque -> added
                    slope = added if probe == 1 else (added - slope) / 0.01
                rotor_damping = max(0.0, slope)
                torque = gear * (added + rotor_damping * gear * rate[m] / radius)
                own_inertia = p[P_motor_rotor_inertia]
                own_inertia *= 1.0 + side[m] * p[P_motor_rotor_inertia_difference]
                turning = gear * gear * own_inertia + p[P_winch_drum_inertia]
                inertia = turning / (radius * radius) + hung[m]
                own_damping = p[P_motor_rotor_damping]
                own_damping *= 1.0 + side[m] * p[P_motor_rotor_damping_difference]
                damping = gear * gear * (own_damping + rotor_damping) / (radius * radius)
                external = -9.80665 * hung[m]  # standard gravity [m/s²]
                # @ port tendon.force -> external
                extra = 0.0
                # @ port tendon.extra_length -> extra
                extra_length[m] = extra
                elasticity = p[P_tendon_stiffness]
                # @ port tendon.stiffness -> elasticity
                share = elasticity / p[P_tendon_stiffness]
                give[m] = step * share * tendon_damping
                weight[m] = inertia + step * damping
                free[m] = free_rate(rate[m], torque / radius + external, inertia, damping, step)
                if begun[0] + substep > 0:
                    seen = (shortening_rate[m] - previous_rate[m]) / step
                    arm_accel[m] += 0.3 * (seen - previous_accel[m] - arm_accel[m])
                demand[m] = demanded_tension(
                    displacement[m] - shortening[m] - extra,
                    free[m],
                    shortening_rate[m],
                    arm_accel[m],
                    elasticity,
                    share * tendon_damping,
                    step,
                )
            tension[0], tension[1] = one_sided_tensions(
                demand[0],
                demand[1],
                1.0 + give[0] * (1.0 / weight[0] + mobility[0, 0]),
                give[0] * mobility[0, 1],
                give[1] * mobility[1, 0],
                1.0 + give[1] * (1.0 / weight[1] + mobility[1, 1]),
            )
            for m in range(motors):
                previous_rate[m] = shortening_rate[m]
                previous_accel[m] = mobility[m, 0] * tension[0] + mobility[m, 1] * tension[1]
                rate[m] = free[m] - step * tension[m] / weight[m]
                displacement[m] += step * rate[m]
                turned[m] += step * rate[m] / radius_now[m]
            if READS_hinge_weight:
                hinge_weights(qpos, units, hinge_weight)
            for i in range(hinges):
                hinge_torque = 0.0
                # @ port body.hinge_torque -> hinge_torque
                applied[i] = hinge_torque + tension[0] * pull[0, i] + tension[1] * pull[1, i]
            if untouched:
                chain_step(qpos, qvel, applied, chain, place, gravity, step, factor, work)
            else:
                mj_step2(model, data)
            pose_tendons(qpos, qvel, guides, rest, arm, shortening, shortening_rate, tendon_work)
        for m in range(motors):
            arm_current[m] = current[m]
            if tension[m] > 0.0:
                efficiency = p[P_winch_efficiency]
                efficiency *= 1.0 + side[m] * p[P_winch_efficiency_difference]
                scale = efficiency * gear * p[P_motor_torque_constant] / radius_now[m]
                square = gear * gear / (radius_now[m] * radius_now[m])
                accel = (
                    (shortening_rate[m] - arm_rate_before[m]) - (rate[m] - rate_before[m])
                ) / cycle_time
                slip = shortening_rate[m] - rate[m]
                arm_current[m] += (
                    square
                    * (
                        p[P_motor_rotor_inertia]
                        * (1.0 + side[m] * p[P_motor_rotor_inertia_difference])
                        * accel
                        + p[P_motor_rotor_damping]
                        * (1.0 + side[m] * p[P_motor_rotor_damping_difference])
                        * slip
                    )
                    + (p[P_winch_drum_inertia] / (radius_now[m] * radius_now[m]) + hung[m]) * accel
                ) / scale
        if not (np.isfinite(rate[0] + rate[1]) and np.isfinite(qvel.sum())):
            return cycle
        begun[0] += 1.0
    return -1
