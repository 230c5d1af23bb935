"""Plays logs in an exported MuJoCo model, with its controller where it has one.

The joint is led along the measured motion; sought is the effort at which drive, effects and model
together make the measured acceleration.  Further joints that the export added move by themselves.
"""
# mypy: ignore-errors

import copy
import importlib.util

import mujoco
import numpy as np

PASSES = 12


class Played:
    """A model, its data, and the controller beside it."""

    def __init__(self, folder, about):
        self.model = mujoco.MjModel.from_xml_path(str(folder / f"{about['name']}.xml"))
        self.data, self.step = mujoco.MjData(self.model), float(self.model.opt.timestep)
        self.dof = int(self.model.joint(about["joint"]).dofadr[0])
        self.drive = int(self.model.actuator("drive").id)
        self.others = {int(self.model.joint(n).dofadr[0]): n for n in about["others"]}
        self.module = self.controller = None
        if about["controller"]:
            spec = importlib.util.spec_from_file_location(
                "exported", folder / f"{about['name']}.py"
            )
            self.module = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(self.module)
            self.controller = self.module.Controller(self.model)

    def begin(self, time, position, speed, acceleration):
        """Forget everything; a load on a spring begins as far behind as it takes to move along."""
        mujoco.mj_resetData(self.model, self.data)
        for k in range(self.model.njnt):
            if self.model.joint(k).name == "behind":
                stiffness = float(self.model.tendon_stiffness[self.model.tendon("shaft").id])
                twist = acceleration * float(self.model.dof_M0[k]) / stiffness
                self.data.joint(k).qpos[0], self.data.joint(k).qvel[0] = position - twist, speed
        if self.controller:
            self.controller.reset()
            self.controller.state.time = float(time)

    def lead(self, motion):
        """Put the measured joints where they were; motion: dof -> position, speed, acceleration."""
        for dof, (q, v, a) in motion.items():
            self.data.qpos[dof], self.data.qvel[dof], self.data.qacc[dof] = q, v, a

    def given(self, effort):
        """What drive and effects put on the joint at this effort, without keeping memory."""
        data = self.data
        data.ctrl[self.drive] = effort
        if self.controller:
            kept = copy.copy(self.controller.state)
            self.controller.before_step(self.model, data)
            self.controller.state = kept
        mujoco.mj_fwdActuation(self.model, data)
        return float(data.qfrc_actuator[self.dof] + data.qfrc_applied[self.dof])

    def needed(self, motion):
        """What the joint needs beside what the model itself puts on it."""
        model, data = self.model, self.data
        data.qacc[:] = 0.0
        self.lead(motion)
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_inverse(model, data)
        return float(data.qfrc_inverse[self.dof])

    def effort(self, motion, guess):
        """The effort of a row."""
        effort, step, last, moved = guess, 1.0 / self.gain(), None, 0.0
        wanted = self.needed(motion)
        for _ in range(PASSES):
            given = self.given(effort)
            if self.controller:  # it moves the slope of friction into the joint's damping
                wanted = self.needed(motion)
            miss = wanted - given
            if abs(miss) <= 1e-10 * (1e-9 + abs(wanted)):
                break
            if last is not None:
                flat = miss * last > 0 and abs(miss) > 0.5 * abs(last)
                step = 2.0 * step if flat else (moved / (last - miss) if last != miss else step)
            moved, last = step * miss, miss
            effort += moved
        return effort

    def gain(self):
        """Torque for one unit of effort, roughly."""
        return float(self.model.actuator_gainprm[self.drive, 0]) or 1.0

    def parts(self, dt):
        """Steps of the model in which a row is passed; effects alone need no more than one."""
        if self.controller:
            return 1
        return max(1, int(np.ceil(dt / self.step - 1e-6)))

    def read(self, values, dt, lag):
        """What the model's own log shows of these efforts, with its lag or its latency alone."""
        model, data = self.model, self.data
        sensor, reading = data.sensor("effort"), model.actuator("reading")
        filtered = float(reading.dynprm[0])
        model.opt.timestep, reading.dynprm[0] = dt, filtered if lag else 0.0
        mujoco.mj_resetData(model, data)
        found = []
        for value in values:
            data.ctrl[reading.id] = value
            mujoco.mj_step(model, data)
            found.append(data.actuator_force[reading.id] if lag else sensor.data[0])
        reading.dynprm[0] = filtered
        return found

    def advance(self, motion, effort, dt):
        """Let memory and further joints go on to the next row."""
        parts = self.parts(dt)
        for k in range(parts):
            x = k * dt / parts
            moved = {
                d: (q + v * x + 0.5 * a * x * x, v + a * x, a) for d, (q, v, a) in motion.items()
            }
            self.lead(moved)
            self.data.ctrl[self.drive] = effort
            if self.controller:
                self.controller.before_step(self.model, self.data)
            mujoco.mj_step(self.model, self.data)


def efforts(played, about, given):
    """Effort and the frame's reading of each row, (n,) each."""
    n = len(given["position"])
    effort, framed = np.zeros(n), given["effort"].copy()
    orders = ("position", "speed", "acceleration")
    columns = {played.dof: [given[o] for o in orders]}
    for dof, name in played.others.items():
        columns[dof] = [given[f"{o} of {name}"] for o in orders]
    motor = getattr(played.module, "motor", None)
    seen = played.module.State() if motor else None
    for k, dt in enumerate(given["steps"]):
        first, last = given["starts"][k], given["starts"][k + 1]
        played.begin(*(given[n][first] for n in ("time", *orders)))
        guess = float(given["effort"][first])
        if seen:
            seen.reset()
        played.model.opt.timestep = dt / played.parts(dt)
        for row in range(first, last):
            motion = {dof: tuple(float(c[row]) for c in cs) for dof, cs in columns.items()}
            if motor:  # the columns are what the sensor tells, with its errors
                motion[played.dof] = motor(seen, *motion[played.dof], dt)
            if played.controller:
                played.controller.state.payload = float(given["payload"][row])
            guess = played.effort(motion, guess)
            effort[row] = guess + given["beside"][row] / played.gain()
            played.advance(motion, guess, dt)
    if "effort" in [played.model.sensor(k).name for k in range(played.model.nsensor)]:
        for k, dt in enumerate(given["steps"]):
            rows = slice(given["starts"][k], given["starts"][k + 1])
            effort[rows] = played.read(effort[rows], dt, True)
            framed[rows] = played.read(given["effort"][rows], dt, False)
    if played.module:
        state = played.module.State()
        for k, dt in enumerate(given["steps"]):
            rows = range(given["starts"][k], given["starts"][k + 1])
            state.reset()
            effort[rows] = [played.module.reported(state, float(effort[r]), dt) for r in rows]
            state.reset()
            framed[rows] = [
                played.module.framed(state, float(given["effort"][r]), dt) for r in rows
            ]
    return effort, framed


def play(folder, about, given):
    """Effort for each row, and the frame's reading of the measured effort."""
    effort, framed = efforts(Played(folder, about), about, given)
    return {"effort": effort, "framed": framed}
