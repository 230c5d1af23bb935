"""MuJoCo with a controller: MJCF, and a Python module that steps every effect beside it."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spirob.export.arm import CorrectedArm
    from spirob.export.corrected import Corrected

HOLDS = "every effect: `before_step(model, data)` of the module adds what MJCF cannot say"
LACKS = "MJX and MJWarp, which call no Python"
LOSSY = False
PLAYER = "mujoco"
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
