"""MuJoCo with a controller: MJCF, and a Python module that steps every effect beside it."""

import copy
import importlib.util
import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spirob.export.arm import CorrectedArm
    from spirob.export.corrected import Corrected

HOLDS = "every effect: `before_step(model, data)` of the module adds what MJCF cannot say"
LACKS = "MJX and MJWarp, which call no Python"
LOSSY = False
PASSES = 12
STEPS = 2  # of an arm's body in a cycle
CONTROLLER = '''

class Controller:
    """Steps the effects of the machine: call `before_step` ahead of every `mujoco.mj_step`.

    The control of the actuator `{drive}` is the effort as the drive reads it.  The slope of
    friction goes into the joint's damping, which MuJoCo solves implicitly: `model` changes there.
    """

    def __init__(self, model, joint="{joint}", tendon="{tendon}"):
        import mujoco

        self._mujoco, self.state = mujoco, State()
        self.joint, self.tendon = model.joint(joint), model.tendon(tendon) if tendon else None
        self.dof, self.drive = int(self.joint.dofadr[0]), int(model.actuator("{drive}").id)
        self.damping = float(model.dof_damping.reshape(model.nv, -1)[self.dof, 0])
        self.slope, self.has_body = 0.0, {has_body}

    def reset(self):
        """Forget everything."""
        self.state.reset()

    def before_step(self, model, data):
        """Put on the joint what drive and effects add to what the model says already."""
        mujoco, dof = self._mujoco, self.dof
        dampings = model.dof_damping.reshape(model.nv, -1)
        if self.has_body or self.tendon:
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
        position, speed, lever = self.moved(data)
        acceleration, effort = float(data.qacc[dof]) * lever, float(data.ctrl[self.drive])
        if self.has_body:
            self.carry(model, data, acceleration, speed, position, lever)
        dt, nudge = model.opt.timestep, 1e-3 * REST_SPEED
        aside = copy.copy(self.state)
        faster = torque(aside, position, speed + nudge, acceleration, effort, dt)
        here = torque(self.state, position, speed, acceleration, effort, dt)
        said = SCALE * (effort - BACK_EMF * speed)
        rise = (faster - here) / nudge + SCALE * BACK_EMF
        # a law that takes an acceleration from its speeds has no slope of friction
        self.slope = min(0.0, rise) if abs(rise) * dt < 0.5 * (INERTIA or 1.0) else 0.0
        dampings[dof, 0] = self.damping - self.slope * lever * lever
        data.qfrc_applied[dof] = lever * (here - said - self.slope * speed)

    def moved(self, data):
        """Position and speed of the drive, and its way for one unit of the joint's."""
        if self.tendon is None:
            return float(data.qpos[self.joint.qposadr[0]]), float(data.qvel[self.dof]), 1.0
        k = int(self.tendon.id)
        speed, own = float(data.ten_velocity[k]), float(data.qvel[self.dof])
        lever = speed / own if own else 1.0
        return float(data.ten_length[k]), speed, lever

    def carry(self, model, data, acceleration, speed, position, lever):
        """Tell the effects what the body behind the axis asks for."""
        mujoco, dof = self._mujoco, self.dof
        moved = self._array(model.nv)
        mujoco.mj_mulM(model, data, moved, data.qacc)
        needed = (moved[dof] + data.qfrc_bias[dof] - data.qfrc_passive[dof]) / lever
        own = INERTIA * acceleration + STIFFNESS * position + (VISCOUS - self.slope) * speed
        self.state.carried = float(needed - own)
        jacobian = self._array((3, model.nv))
        mujoco.mj_jacSubtreeCom(model, data, jacobian, 0)
        size = sum(float(x) ** 2 for x in model.opt.gravity) ** 0.5
        weight = float(model.body_subtreemass[0]) * size
        self.state.weight_x = weight * float(jacobian[0, dof])
        self.state.weight_y = weight * float(jacobian[1, dof])

    @staticmethod
    def _array(shape):
        import numpy as np

        return np.zeros(shape)

    def read(self, data):
        """(position, effort) as sensors and log of the machine show them; once for each cycle."""
        position, _, _ = self.moved(data)
        effort = float(data.ctrl[self.drive])
        effort = framed(self.state, reported(self.state, effort, CYCLE), CYCLE)
        return seen(self.state, position, self.state.carried), effort


CYCLE = 1e-3  # s, of the bus
'''


def arm(model: "CorrectedArm") -> dict[str, str]:
    """The same of an arm: its body, and the coupled loop of motors, winches and tendons."""
    from spirob.export.arm_mujoco import arm_module
    from spirob.export.body import bare
    from spirob.export.code import about, c_name

    name = c_name(model.name)
    said = [f"{name}.xml: the body of the arm.  Motors, winches and tendons are in {name}.py"]
    told = about(model.name, model.sentence, [e.name() for e in model.effects])
    return {f"{name}.xml": bare(model).text(said), f"{name}.py": arm_module(model, name, told)}


def files(model: "Corrected") -> dict[str, str]:
    """Name of each file -> its text."""
    from spirob.export.axis import BUILT
    from spirob.export.body import DRIVE, machine_of
    from spirob.export.code import c_name, python_text
    from spirob.export.native import tip, usual

    machine, name = machine_of(model), c_name(model.name)
    usual(machine, model)
    for one in model.at(BUILT):
        tip(machine, one, model)
    module = python_text(model).replace("\nimport math\n", "\nimport copy\nimport math\n")
    controller = CONTROLLER.format(
        joint=_quoted(machine.joint),
        tendon=_quoted(machine.tendon),
        drive=DRIVE,
        has_body=model.body is not None,
    )
    said = [
        f"{name}.xml: the body and drive of this machine.  What it misses is in {name}.py:",
        f"    controller = {name}.Controller(model)",
        "    controller.before_step(model, data)  # ahead of each mj_step",
    ]
    return {f"{name}.xml": machine.text(said), f"{name}.py": module + controller}


def _quoted(name: str) -> str:
    """A name of a model file inside quotes of Python."""
    return name.encode("unicode_escape").decode("ascii").replace('"', '\\"')


class Played:
    """An exported model of a rig, its data, and the controller beside it.

    The joint is led along the measured motion; sought is the effort at which drive, effects and
    model together make the measured acceleration.  Further joints that the export added move by
    themselves.
    """

    def __init__(self, folder, about):
        import mujoco

        self.mujoco = mujoco
        self.model = mujoco.MjModel.from_xml_path(str(folder / f"{about['name']}.xml"))
        self.data, self.step = mujoco.MjData(self.model), float(self.model.opt.timestep)
        self.dof = int(self.model.joint(about["joint"]).dofadr[0])
        self.drive = int(self.model.actuator("drive").id)
        self.others = {int(self.model.joint(n).dofadr[0]): n for n in about["others"]}
        self.module = self.controller = None
        if about["controller"]:
            self.module = _module(folder, about)
            self.controller = self.module.Controller(self.model)

    def begin(self, time, position, speed, acceleration):
        """Forget everything; a load on a spring begins as far behind as it takes to move along."""
        self.mujoco.mj_resetData(self.model, self.data)
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
        self.mujoco.mj_fwdActuation(self.model, data)
        return float(data.qfrc_actuator[self.dof] + data.qfrc_applied[self.dof])

    def needed(self, motion):
        """What the joint needs beside what the model itself puts on it."""
        model, data = self.model, self.data
        data.qacc[:] = 0.0
        self.lead(motion)
        self.mujoco.mj_fwdPosition(model, data)
        self.mujoco.mj_fwdVelocity(model, data)
        self.mujoco.mj_inverse(model, data)
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
        return max(1, math.ceil(dt / self.step - 1e-6))

    def read(self, values, dt, lag):
        """What the model's own log shows of these efforts, with its lag or its latency alone."""
        model, data = self.model, self.data
        sensor, reading = data.sensor("effort"), model.actuator("reading")
        filtered = float(reading.dynprm[0])
        model.opt.timestep, reading.dynprm[0] = dt, filtered if lag else 0.0
        self.mujoco.mj_resetData(model, data)
        found = []
        for value in values:
            data.ctrl[reading.id] = value
            self.mujoco.mj_step(model, data)
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
            self.mujoco.mj_step(self.model, self.data)


def efforts(played, about, given):
    """Effort and the frame's reading of each row, (n,) each."""
    import numpy as np

    n = len(given["position"])
    effort, framed = np.zeros(n), given["effort"].copy()
    orders = ("position", "speed", "acceleration")
    columns = {played.dof: [given[o] for o in orders]}
    for dof, name in played.others.items():
        columns[dof] = [given[f"{o} of {name}"] for o in orders]
    motor = getattr(played.module, "motor", None)
    seen = played.module.State() if motor else None
    starts = given["starts"]
    pieces = list(zip(starts[:-1], starts[1:], given["steps"], strict=True))
    for first, last, dt in pieces:
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
        for first, last, dt in pieces:
            rows = slice(first, last)
            effort[rows] = played.read(effort[rows], dt, True)
            framed[rows] = played.read(given["effort"][rows], dt, False)
    if played.module:
        state = played.module.State()
        for first, last, dt in pieces:
            rows = range(first, last)
            state.reset()
            effort[rows] = [played.module.reported(state, float(effort[r]), dt) for r in rows]
            state.reset()
            framed[rows] = [
                played.module.framed(state, float(given["effort"][r]), dt) for r in rows
            ]
    return effort, framed


def play(folder, about, given):
    """Of a rig the effort for each row, and the frame's reading; of an arm its currents."""
    if "trials" in about:
        return _arm(folder, about, given)
    effort, framed = efforts(Played(folder, about), about, given)
    return {"effort": effort, "framed": framed}


def _arm(folder, about, given):
    """Currents of each trial of an arm, (T, 2)."""
    import mujoco

    module = _module(folder, about)
    model = mujoco.MjModel.from_xml_path(str(folder / f"{about['name']}.xml"))
    result = {}
    for k in range(about["trials"]):
        data, controller = mujoco.MjData(model), module.Controller(model, given[f"angle_{k}"])
        controller.start(model, data)
        controller.mode[:], controller.limit[:] = given[f"mode_{k}"], given[f"limit_{k}"]
        wanted, rates = given[f"reference_{k}"], given[f"rate_{k}"]
        result[f"current_{k}"] = current = 0.0 * wanted
        for cycle in range(len(wanted)):
            controller.reference[:], controller.reference_rate[:] = wanted[cycle], rates[cycle]
            for step in range(STEPS):
                controller.before_step(model, data)
                if step == 0:
                    current[cycle] = controller.read("current")
                mujoco.mj_step(model, data)
    return result


def _module(folder, about):
    """What was written in Python beside the model."""
    spec = importlib.util.spec_from_file_location("exported", folder / f"{about['name']}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
