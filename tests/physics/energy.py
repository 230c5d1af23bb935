"""An account of energy from the outside: what goes in, what is stored, what is lost.

Electrical input comes from a drive simulated again, sample by sample, from the logged command and
speed; heat, work and loss are integrated from logged currents, rates and tensions by the
trapezoidal rule; stored energy is MuJoCo's own for the arm, ½ k e² for the tendon.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from spirob.control import Schedule
from spirob.plant import Plant
from spirob.plant.motor import current_loop_gains, drive_current
from spirob.robot import Scene

DT = 1e-3


@dataclass
class Account:
    """Energies [J] over a trial, both motors together; losses are positive."""

    electrical: float
    winding_heat: float
    magnetic: float
    shaft: float
    gear_loss: float
    rotor_heat: float
    rotor_kinetic: float
    drum: float
    tendon_heat: float
    tendon_elastic: float
    arm_work: float
    arm_heat: float
    arm_kinetic: float
    arm_potential: float
    forward_shaft: float  # the part of `shaft` where the motor drives the load
    backward_shaft: float  # ... and where the load drives the motor, negative


def integral(values):
    """∫ values dt by the trapezoidal rule, summed over columns."""
    return float(np.trapezoid(values, dx=DT, axis=0).sum())


def account(rig, schedule, scene=None):
    """Play a schedule cycle by cycle and book every energy."""
    plant = Plant(rig)
    session = plant.start(scene or Scene())
    model, data = session._model, session._data
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    mujoco.mj_forward(model, data)
    before = data.energy.copy()
    rows, speeds = [], [data.qvel.copy()]
    for k in range(schedule.cycles):
        row = slice(k, k + 1)
        rows.append(session.play(part(schedule, row)))
        speeds.append(data.qvel.copy())
    mujoco.mj_forward(model, data)
    log = {c: stacked(rows, c) for c in ("current", "velocity", "tension", "shortening_rate")}
    stretch = stacked(rows, "displacement") - stacked(rows, "shortening")
    command = np.array([r.command[0] for r in rows])
    potential, kinetic = data.energy - before
    return book(rig, log, stretch, command, np.array(speeds), model, potential, kinetic)


def part(schedule, row):
    """Some cycles of a schedule."""
    rates = schedule.reference_rate[row]
    return Schedule(schedule.mode, schedule.reference[row], rates, schedule.current_limit)


def stacked(rows, column):
    """One column of all cycles and of the state after the last."""
    return np.array([getattr(r, column)[0] for r in rows] + [getattr(rows[-1], column)[1]])


def book(rig, log, stretch, command, speeds, model, potential, kinetic):
    """Turn logged signals into energies."""
    gear, radius = rig.winch.gear_ratio, rig.winch.radius
    current, rate, tension = log["current"], log["velocity"], log["tension"]
    motor = rig.motor
    rotor = gear * rate / radius
    electrical, heat, torque = electrical_account(rig, command, rotor)
    shaft = integral(torque * rotor)
    square = (gear / radius) ** 2
    joint_damping = model.dof_damping.reshape(model.nv, -1)[:, 0]
    slip = rate - log["shortening_rate"]
    taut = tension > 0.0
    return Account(
        electrical=electrical,
        winding_heat=heat,
        magnetic=float((0.5 * motor.inductance * current[-1] ** 2).sum()),
        shaft=shaft,
        gear_loss=(1.0 - rig.winch.efficiency) * shaft,
        rotor_heat=integral(square * motor.rotor_damping * rate**2),
        rotor_kinetic=float((0.5 * square * motor.rotor_inertia * rate[-1] ** 2).sum()),
        drum=integral(tension * rate),
        tendon_heat=integral(rig.tendon.damping * slip**2 * taut),
        tendon_elastic=float((0.5 * rig.tendon.stiffness * (stretch * taut)[-1] ** 2).sum()),
        arm_work=integral(tension * log["shortening_rate"]),
        arm_heat=integral(joint_damping * speeds**2),
        arm_kinetic=float(kinetic),
        arm_potential=float(potential),
        forward_shaft=integral(np.maximum(torque * rotor, 0.0)),
        backward_shaft=integral(np.minimum(torque * rotor, 0.0)),
    )


def electrical_account(rig, command, rotor):
    """∫u·i dt, ∫R·i² dt [J] and the torque k_t·i at every cycle, from a drive played again.

    The speed is interpolated within a cycle.  u follows from the circuit's exact step:
    i(t + T) = i(t) E + (u - k_e ω)/R (1 - E).
    """
    motor, samples = rig.motor, 20
    period = DT / samples
    gains = current_loop_gains(motor.resistance, motor.inductance, rig.drive.bandwidth)
    fading = np.exp(-motor.resistance * period / motor.inductance)
    cycles = len(command)
    electrical = heat = 0.0
    torque = np.zeros((cycles + 1, 2))
    for m in range(2):
        now = integral_state = last = 0.0
        for k in range(cycles):
            held = np.linspace(rotor[k, m], rotor[k + 1, m], samples, endpoint=False)
            torque[k, m] = motor.torque_constant * now
            slope = (command[k, m] - last) / DT
            for emf in motor.emf_constant * held:
                following, integral_state, mean = drive_current(
                    now,
                    integral_state,
                    command[k, m],
                    slope,
                    0.0,
                    emf,
                    0.0,
                    1,
                    period,
                    motor.resistance,
                    motor.inductance,
                    *gains,
                    rig.drive.emf_compensation,
                    rig.drive.voltage_limit,
                )
                final = (following - now * fading) / (1.0 - fading)
                voltage = motor.resistance * final + emf
                electrical += voltage * mean * period
                # ∫R i² exactly, from ∫u i = ∫R i² + Δ½Li² + ∫emf i
                stored = 0.5 * motor.inductance * (following**2 - now**2)
                heat += voltage * mean * period - stored - emf * mean * period
                now = following
            last = command[k, m]
        torque[cycles, m] = motor.torque_constant * now
    return electrical, heat, torque
