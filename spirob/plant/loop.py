# ruff: noqa: F821
"""The coupled cycle, as a template: `plant.assemble` fills in the ports and compiles it.

    report   what the drives say                                   (effects at `sensing`)
    command  feedback law -> i_cmd, and the host's voltage         (control)
    j_a      drive and R-L circuit -> i*                           (steps, motor)
    j_b      i* -> torque at the drum                              (steps)
    j_c      rotors, tendons and arm together -> F, Δl, dΔl/dt     (steps, motor, chain or MuJoCo)
    rebuilt  i** out of the arm's motion

j_a, j_b and j_c are repeated for each substep.  Row k of the output is the state at the start of
the cycle, as the drive reports it, with the command that follows from it; one more row holds the
state after the last cycle.

All of them work on the records of `plant.records`: p numbers by owner, s state, w what one step
leaves to the next, c settings, arm what is known of the arm, moved what MuJoCo moves of it, laws
what effects know and remember.  m counts motors, left and right, i hinges from the base.

A comment `# @ port name -> variable` is replaced by one statement for each effect at that port;
`repeat` applies them to another signal, `probe` asks them at another speed.  `READS_...` is whether
an effect reads a signal, `HOST_LOOP` whether the host closes the current loop, by voltages that it
holds for a cycle, or the drive.
"""


def report(p, s, w, c, laws, m, row):
    """What a motor's drive reports, into its row of the output."""
    sensed_displacement = c.radius * s.turned[m]
    # @ port sensing.displacement -> sensed_displacement
    if s.cycle == 0.0:
        s.reading_zero[m] = sensed_displacement - c.radius * s.turned[m]
    sensed_displacement -= s.reading_zero[m]
    # @ port sensing.frame -> sensed_displacement
    # the drive differentiates the length that it reports
    error = sensed_displacement - c.radius * s.turned[m]
    sensed_velocity = c.radius * s.rate[m] / s.radius[m]
    sensed_velocity += (error - s.reading_error[m]) / c.cycle
    if not w.last:
        s.reading_error[m] = error
    sensed_current = s.current[m]
    # @ port sensing.current -> sensed_current
    w.misread[m] = sensed_current - s.current[m]
    # @ port sensing.report -> sensed_current
    # @ repeat sensing.frame -> sensed_current
    sensed_arm_current = s.arm_current[m]
    # @ repeat sensing.current -> sensed_arm_current
    # @ repeat sensing.report -> sensed_arm_current
    # @ repeat sensing.frame -> sensed_arm_current
    row.current = sensed_current
    row.arm_current = sensed_arm_current
    row.displacement = sensed_displacement
    row.velocity = sensed_velocity
    row.shortening = s.shortening[m]
    row.shortening_rate = s.shortening_rate[m]
    row.tension = s.tension[m]


def command(p, s, w, c, laws, m, reference, reference_rate, row):
    """The current that a motor is told by what its drive reported, and the host's voltage."""
    w.command_before[m] = s.command[m]
    wanted, s.command_integral[m] = current_command(
        c.mode[m],
        reference,
        reference_rate,
        row.displacement,
        row.velocity,
        row.current,
        s.command_integral[m],
        c.cycle,
        c.limit[m],
        c.velocity,
        c.integral,
        c.displacement,
        c.force,
        c.newton_per_ampere,
        c.drag,
    )
    # @ port command.current -> wanted
    s.command[m] = wanted
    row.command = wanted
    if HOST_LOOP:
        row.current = counted(row.current + row.noise, c.host_current_count)
        if s.cycle == 0.0:
            s.host_error[m] = wanted - row.current
        s.volts[2, m], s.volts[1, m] = s.volts[1, m], s.volts[0, m]
        volts, s.host_integral[m], s.host_error[m] = host_voltage(
            wanted,
            w.command_before[m],
            row.current,
            s.host_error[m],
            counted(p.winch.gear_ratio * row.velocity / c.radius, c.host_speed_count),
            s.host_integral[m],
            c.cycle,
            c.host_resistance,
            c.host_inductance,
            c.host_emf,
            c.host_proportional,
            c.host_integral,
            c.host_derivative,
            c.host_limit,
        )
        s.volts[0, m] = c.host_count * np.rint(volts / c.host_count)  # counts on the bus
        row.voltage = s.volts[0, m]


def rebuilt(p, s, w, c, m):
    """i** out of the arm's motion, by (17).

    i** = (J_eq Δl̈/r + b_eq Δl̇/r + r F + r m (g + Δl̈) - G τ_effects)/(η G k_t)

    with m a weight on the drum, where the scene hangs one there.  It is written as i* plus the
    difference between the arm's motion and the rotor's, which is the same equation (the rotor
    satisfies it with i*) and holds with every effect; a slack tendon tells the rotor nothing of
    the arm, and there i** = i*.
    """
    if not s.tension[m] > 0.0:
        return s.current[m]
    gear, radius = p.winch.gear_ratio, s.radius[m]
    efficiency = own(p.winch.efficiency, p.winch.efficiency_difference, m)
    scale = efficiency * gear * p.motor.torque_constant / radius
    square = gear * gear / (radius * radius)
    arm_change = s.shortening_rate[m] - w.cycle_shortening_rate[m]
    accel = (arm_change - (s.rate[m] - w.cycle_rate[m])) / c.cycle
    slip = s.shortening_rate[m] - s.rate[m]
    inertia = own(p.motor.rotor_inertia, p.motor.rotor_inertia_difference, m)
    damping = own(p.motor.rotor_damping, p.motor.rotor_damping_difference, m)
    apart = square * (inertia * accel + damping * slip)
    apart += (p.winch.drum_inertia / (radius * radius) + s.hung[m]) * accel
    return s.current[m] + apart / scale


def pose(s, arm, moved):
    """Both tendons in the arm's present pose."""
    pose_tendons(
        moved.qpos,
        moved.qvel,
        arm.guides,
        arm.rest,
        arm.lever,
        s.shortening,
        s.shortening_rate,
        arm.lengths,
    )


def begin(p, s, arm, moved):
    """The drums as they are when a trial begins, and the tendons in the arm's present pose."""
    for m in range(2):
        if s.cycle == 0.0:
            s.radius[m] = own(p.winch.radius, p.winch.radius_difference, m)
    columns = arm.guides
    for m in range(2):
        first = 5 * m
        for i in range(columns.shape[1]):
            arm.rest[m, i], _ = guide_length(
                1.0,
                0.0,
                1.0,
                columns[first, i],
                columns[first + 1, i],
                columns[first + 2, i],
                columns[first + 3, i],
                columns[first + 4, i],
            )
    pose(s, arm, moved)


def run(
    numbers, state, passing, settings, arms, moved, laws, reference, reference_rate, out, angles
):
    """Simulate all cycles; returns the cycle where a state became non-finite, or -1.

    numbers, state, passing, settings, arms  p, s, w, c and arm, arrays of one;  moved  a `Moved`
    laws           `assemble.Laws`
    reference      (T, 2) of the law, in the unit of its mode;  reference_rate  (T, 2) [m/s]
    out            (T + 1, 2) filled, `records.ROW`, but for its noise, which is given
    angles         (T + 1, N) filled [rad]
    """
    p, s, w, c, arm = numbers[0], state[0], passing[0], settings[0], arms[0]
    cycles = reference.shape[0]
    begin(p, s, arm, moved)
    for cycle in range(cycles + 1):
        w.time = s.cycle * c.cycle
        w.last = cycle == cycles
        for m in range(2):
            row = out[cycle, m]
            report(p, s, w, c, laws, m, row)
            if not w.last:
                asked, asked_rate = reference[cycle, m], reference_rate[cycle, m]
                command(p, s, w, c, laws, m, asked, asked_rate, row)
            w.cycle_rate[m] = s.rate[m]
            w.cycle_shortening_rate[m] = s.shortening_rate[m]
        for i in range(arm.stiffness.shape[0]):
            angles[cycle, i] = moved.qpos[i]
        if w.last:
            break
        for substep in range(c.substeps):
            w.substep = substep
            for m in range(2):
                j_a(p, s, w, c, laws, m)
                j_b(p, s, w, c, laws, m)
            untouched = j_c(p, s, w, c, arm, moved, laws)
            body_moves(c, arm, moved, untouched)
            pose(s, arm, moved)
        for m in range(2):
            s.arm_current[m] = rebuilt(p, s, w, c, m)
        if not (np.isfinite(s.rate[0] + s.rate[1]) and np.isfinite(moved.qvel.sum())):
            return cycle
        s.cycle += 1.0
    return -1
