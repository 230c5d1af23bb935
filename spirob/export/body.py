"""The machine, or the arm, as a MuJoCo model: its body with the fitted numbers, and the drive.

`drive` is an actuator whose control is the effort, in the unit of the diagnosis.  Where no model
file describes the body, the axis is a joint of that name with the fitted inertia.

The arm's body is bare here, for the coupled loop; `arm_mujoco` adds winches and tendons.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from spirob.errors import ConfigError, ExportError
from spirob.export.arm import CorrectedArm
from spirob.export.corrected import Corrected
from spirob.machine.description.model_file import checked, unheard
from spirob.plant.body import build_spec
from spirob.plant.plant import CYCLE, SUBSTEPS
from spirob.robot import Scene

STEP = 1e-3  # s, at most
DRIVE, AXIS = "drive", "axis"


@dataclass(frozen=True)
class Machine:
    """A model to be written.

    joint   that the drive moves;  tendon  by which, "" where directly;  drive  its actuator
    """

    spec: mujoco.MjSpec
    joint: str
    tendon: str
    drive: str = DRIVE

    @property
    def driven(self) -> mujoco._specs.MjsJoint:
        """The joint in the model."""
        return self.spec.joint(self.joint)

    def text(self, said: list[str]) -> str:
        """MJCF with these lines in front; raises ExportError where MuJoCo refuses the model."""
        try:
            with unheard():
                self.spec.compile()
                body = self.spec.to_xml()
        except (ValueError, mujoco.FatalError) as error:
            said_by = " ".join(str(error).split())
            raise ExportError(f"MuJoCo refuses the exported model: {said_by}") from None
        kept = "\n".join(line.replace("--", "- -") for line in said)
        return f"<!--\n{kept}\n-->\n{body}"


def machine_of(model: Corrected) -> Machine:
    """The machine without its effects; raises ExportError where it moves no inertia."""
    found = _plain(model) if model.body is None else _described(model)
    spec, numbers = found.spec, model.numbers
    spec.option.timestep = min(STEP, model.period)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    joint = found.driven
    if found.tendon:
        if any(numbers[n] for n in ("inertia", "viscous", "stiffness")):
            tendon = spec.tendon(found.tendon)
            tendon.armature += numbers["inertia"]
            tendon.damping += np.array([numbers["viscous"], 0.0, 0.0])
            tendon.stiffness += np.array([numbers["stiffness"], 0.0, 0.0])
    else:
        if model.body is not None:
            joint.armature += numbers["inertia"]
        joint.damping += np.array([numbers["viscous"], 0.0, 0.0])
        joint.stiffness += np.array([numbers["stiffness"], 0.0, 0.0])
    _drive(found, numbers["scale"], numbers["back_emf"])
    return found


def weigh(body: mujoco._specs.MjsBody, mass: float, inertia: float) -> None:
    """Give a body a mass and the same inertia about every axis."""
    body.explicitinertial, body.mass = True, mass
    body.ipos = [0.0, 0.0, 0.0]  # left out, no inertia is written at all
    body.inertia = np.full(3, inertia)


def _drive(found: Machine, scale: float, back_emf: float) -> None:
    kind = mujoco.mjtTrn.mjTRN_TENDON if found.tendon else mujoco.mjtTrn.mjTRN_JOINT
    drive = found.spec.add_actuator(name=DRIVE, target=found.tendon or found.joint, trntype=kind)
    drive.gaintype, drive.gainprm[0] = mujoco.mjtGain.mjGAIN_FIXED, scale
    if back_emf:
        drive.biastype = mujoco.mjtBias.mjBIAS_AFFINE
        drive.biasprm[:3] = 0.0, 0.0, -scale * back_emf


def _plain(model: Corrected) -> Machine:
    inertia = model.numbers["inertia"]
    if not inertia > 0.0:
        raise ExportError(
            f"{model.name}: the fitted model moves no inertia, so there is no body to write; fit "
            "'inertia', or describe a body"
        )
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.gravity = [0.0, 0.0, 0.0]
    body = spec.worldbody.add_body(name="load")
    turns = model.axis == "rad"
    weigh(body, *((1.0, inertia) if turns else (inertia, 1.0)))
    kind = mujoco.mjtJoint.mjJNT_HINGE if turns else mujoco.mjtJoint.mjJNT_SLIDE
    body.add_joint(name=AXIS, type=kind, axis=[0, 0, 1] if turns else [1, 0, 0])
    size = mujoco.mjtGeom.mjGEOM_BOX
    body.add_geom(type=size, size=[0.1, 0.02, 0.02], mass=0.0, contype=0, conaffinity=0)
    return Machine(spec, AXIS, "")


def _described(model: Corrected) -> Machine:
    """The body of the model file, by its inertias: without meshes, and nothing collides in it."""
    body = model.body
    assert body is not None
    try:
        text, meshes = checked(body.file)
        with unheard():
            spec = mujoco.MjSpec.from_string(text, assets=meshes)
            made = spec.compile()
    except (ConfigError, ValueError, mujoco.FatalError) as error:
        raise ExportError(f"{body.file}: {' '.join(str(error).split())[:200]}") from None
    for own in spec.bodies[1:]:
        k = own.id
        own.explicitinertial, own.mass = True, made.body_mass[k]
        own.ipos, own.iquat, own.inertia = (
            made.body_ipos[k],
            made.body_iquat[k],
            made.body_inertia[k],
        )
    for geom in list(spec.geoms):
        if geom.type == mujoco.mjtGeom.mjGEOM_MESH:
            spec.delete(geom)
    for mesh in list(spec.meshes):
        spec.delete(mesh)
    for actuator in list(spec.actuators):
        spec.delete(actuator)
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    joint = body.joint or _moved(made, body.tendon, body.others)
    return Machine(spec, joint, body.tendon)


def _moved(made: mujoco.MjModel, tendon: str, others: tuple[str, ...]) -> str:
    """The joint that a tendon moves: the one without a column of its own."""
    names = [made.joint(k).name for k in range(made.njnt)]
    free = [name for name in names if name not in others]
    if len(free) != 1 or mujoco.mj_name2id(made, mujoco.mjtObj.mjOBJ_TENDON, tendon) < 0:
        raise ExportError(f"the model has no tendon '{tendon}' that moves one joint")
    return free[0]


def bare(model: CorrectedArm) -> Machine:
    """The body alone, with the payload that was named, stepped as the model here is."""
    plant = model.plant()
    p = plant.table.vector(model.changes)
    spec = build_spec(
        plant.arm(p), Scene(), model.rig.lengths(), CYCLE / SUBSTEPS, tip_mass=plant.tip_mass(p)
    )
    return Machine(spec, "hinge_0", "")
