"""The body behind the motor: none, or a MuJoCo model with a driven joint or tendon.

What the body asks of the drive at a measured motion does not depend on any number that is fitted,
except a payload's mass, in which it is linear: so it is computed once, by inverse dynamics.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import mujoco
import numpy as np

from spirob.errors import ConfigError, DataError
from spirob.files import inside
from spirob.machine.description.model_file import load
from spirob.machine.description.rig import Body
from spirob.machine.recordings.recording import Piece
from spirob.units import MOST

BEYOND = 0.25  # of a joint's range, by which a log may exceed it


class RigidBody:
    """Inverse dynamics of a model in which one joint or tendon is driven.

    Contacts and joint limits are switched off: a measured motion that grazes them would ask for
    forces that no motor gave.
    """

    def __init__(self, body: Body, folder: Path, angular: bool):
        self.body = body
        self.file = inside(body.mjcf, folder, "body.mjcf")
        self.model = load(body.mjcf, folder)
        self.data = mujoco.MjData(self.model)
        self._angular = angular
        self._columns = self._place()
        self.mass = float(self.model.body_mass.sum())
        self.stiffness = self._stiffness()

    def needs(self, piece: Piece, unit_mass: float) -> dict[str, np.ndarray]:
        """What the drive has to give along a piece, each (n,).

        load      effort at the driven axis [N·m or N]
        payload   what one `unit_mass` [kg] at the tip adds, 0 without a tip
        along, across   torque of the weight if gravity pointed along +x or +y

        Raises DataError where the motion leaves the model's ranges, or the model is no machine.
        """
        self._within_range(self._motion(piece, 0))
        load = self.load(piece)
        if not np.all(np.abs(load) <= MOST):  # no number is not either
            raise DataError(
                f"{self.body.mjcf}: the body asks for an effort of {np.abs(load).max():.3g}; is a "
                "mass, a stiffness or the gravity of the model wrong?"
            )
        return {
            "load": load,
            "payload": self.payload(piece, unit_mass, load),
            **self.weights(piece),
        }

    def load(self, piece: Piece) -> np.ndarray:
        """Effort at the driven axis along a piece, (n,) [N·m or N]."""
        return self._inverse(*(self._motion(piece, k) for k in range(3)))

    def payload(self, piece: Piece, mass: float, load: np.ndarray) -> np.ndarray:
        """What a mass [kg] at the tip adds to `load` along a piece, (n,); 0 without a tip."""
        if self.body.tip is None:
            return np.zeros(len(piece.q))
        return self._with_payload(mass, *(self._motion(piece, k) for k in range(3))) - load

    @property
    def heavy(self) -> dict[str, int]:
        """Bodies that weigh something, by name, or by place where they have none."""
        masses = enumerate(self.model.body_mass)
        return {self.model.body(k).name or f"#{k}": k for k, mass in masses if mass > 0.0}

    def doubled(self, name: str, piece: Piece) -> np.ndarray:
        """Effort at the driven axis along a piece if one of `heavy` weighed twice as much, (n,)."""
        body, model = self.heavy[name], self.model
        kept = float(model.body_mass[body]), model.body_inertia[body].copy()
        try:
            model.body_mass[body], model.body_inertia[body] = 2.0 * kept[0], 2.0 * kept[1]
            mujoco.mj_setConst(model, self.data)
            return self.load(piece)
        finally:
            model.body_mass[body], model.body_inertia[body] = kept
            mujoco.mj_setConst(model, self.data)

    def weights(self, piece: Piece) -> dict[str, np.ndarray]:
        """Torque of the weight if gravity pointed "along" +x or "across", along +y, (n,) each."""
        found = {name: np.zeros(len(piece.q)) for name in ("along", "across")}
        gravity = self.model.opt.gravity.copy()
        size = float(np.linalg.norm(gravity))
        if size > 0.0:
            q = self._motion(piece, 0)
            rest = [q, np.zeros_like(q), np.zeros_like(q)]
            self.model.opt.gravity[:] = 0.0
            nothing = self._inverse(*rest)
            for name, axis in (("along", 0), ("across", 1)):
                self.model.opt.gravity[:] = 0.0
                self.model.opt.gravity[axis] = size
                # the torque that the weight exerts is what the drive need not give
                found[name] = nothing - self._inverse(*rest)
            self.model.opt.gravity[:] = gravity
        return found

    @property
    def range(self) -> tuple[float, float]:
        """Positions of a driven joint that a log may reach; a tendon's follow from its joint."""
        joint = self.model.dof_jntid[self._driven]
        if self.body.joint is None or not self.model.jnt_limited[joint]:
            return -np.inf, np.inf
        low, high = (float(x) for x in self.model.jnt_range[joint])
        slack = BEYOND * (high - low)
        return low - slack, high + slack

    @property
    def rubs(self) -> bool:
        """Whether the model file holds dry friction."""
        model = self.model
        return bool(np.any(model.dof_frictionloss > 0) or np.any(model.tendon_frictionloss > 0))

    @contextmanager
    def without_dry_friction(self) -> Iterator[None]:
        """For as long as this lasts the model's dry friction is switched off."""
        kept = int(self.model.opt.disableflags)
        self.model.opt.disableflags = kept | mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS
        try:
            yield
        finally:
            self.model.opt.disableflags = kept

    def _within_range(self, q: np.ndarray) -> None:
        """Raise where a joint goes far beyond what the model allows it."""
        for dof in range(self.model.nv):
            joint = self.model.dof_jntid[dof]
            low, high = self.model.jnt_range[joint]
            slack = BEYOND * (high - low)
            reached = float(q[np.argmax(np.abs(q[:, dof])), dof])
            if self.model.jnt_limited[joint] and not low - slack <= reached <= high + slack:
                raise DataError(
                    f"{self.body.mjcf}: joint '{self.model.joint(joint).name}' reaches "
                    f"{reached:.3g}, where the model allows {low:.3g} to {high:.3g}: is the "
                    "position's unit or zero wrong?"
                )

    def _place(self) -> dict[int, str]:
        """Which degree of freedom each measured joint moves; "" is the driven one."""
        model, body = self.model, self.body
        found: dict[int, str] = {}
        for name in [*([body.joint] if body.joint else []), *body.joints]:
            joint = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
            if joint < 0:
                known = ", ".join(model.joint(k).name or f"#{k}" for k in range(model.njnt))
                raise ConfigError(f"{body.mjcf}: no joint '{name}'; it has: {known}")
            found[int(model.jnt_dofadr[joint])] = "" if name == body.joint else name
        if body.tendon is not None:
            if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TENDON, body.tendon) < 0:
                raise ConfigError(f"{body.mjcf}: no tendon '{body.tendon}'")
            free = [k for k in range(model.nv) if k not in found]
            if len(free) != 1:
                raise ConfigError(
                    f"{body.mjcf}: a tendon's length gives one joint; {len(free)} are left without "
                    "a column in body.joints"
                )
            found[free[0]] = ""
        if len(found) != model.nv or model.nq != model.nv:
            raise ConfigError(
                f"{body.mjcf}: {model.nv} degrees of freedom, but only {len(found)} are measured; "
                "give the others a column in body.joints"
            )
        if body.tip is not None:
            _tip(model, body)
        return found

    def _motion(self, piece: Piece, order: int) -> np.ndarray:
        own = (piece.q, piece.v, piece.a)[order]
        columns = []
        for dof in range(self.model.nv):
            name = self._columns[dof]
            columns.append(own if name == "" else piece.others[name][:, order])
        motion = np.column_stack(columns)
        if self.body.tendon is not None:
            motion[:, self._driven] = self._from_tendon(piece, order)
        return motion

    @property
    def _driven(self) -> int:
        return next(dof for dof, name in self._columns.items() if name == "")

    def _from_tendon(self, piece: Piece, order: int) -> np.ndarray:
        """The one free joint from the tendon's length, speed or acceleration.

        Only for a joint that alone moves the tendon: its length is tabulated over the joint's range
        and inverted, which needs it to be monotone there.
        """
        model, data, dof = self.model, self.data, self._driven
        tendon = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TENDON, self.body.tendon)
        low, high = model.jnt_range[dof] if model.jnt_limited[dof] else (-np.pi, np.pi)
        angles = np.linspace(low, high, 2001)
        lengths = np.empty_like(angles)
        data.qpos[:] = 0.0
        for k, angle in enumerate(angles):
            data.qpos[dof] = angle
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_tendon(model, data)
            lengths[k] = data.ten_length[tendon]
        steps = np.diff(lengths)
        if not (np.all(steps > 0) or np.all(steps < 0)):
            raise ConfigError(
                f"{self.body.mjcf}: the length of '{self.body.tendon}' is no monotone function of "
                "its joint, so the pose does not follow from it; give the joint a range"
            )
        turn = slice(None, None, 1 if steps[0] > 0 else -1)
        arm = np.gradient(lengths, angles)
        angle = np.interp(piece.q, lengths[turn], angles[turn])
        if order == 0:
            return angle
        lever = np.interp(angle, angles, arm)
        if order == 1:
            return piece.v / lever
        bend = np.interp(angle, angles, np.gradient(arm, angles))
        return (piece.a - bend * (piece.v / lever) ** 2) / lever

    def _inverse(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        model, data, dof = self.model, self.data, self._driven
        tendon = (
            mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TENDON, self.body.tendon)
            if self.body.tendon
            else -1
        )
        out = np.empty(len(q))
        for k in range(len(q)):
            data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], a[k]
            mujoco.mj_inverse(model, data)
            out[k] = data.qfrc_inverse[dof]
            if tendon >= 0:
                out[k] /= _lever(model, data, tendon, dof)
        return out

    def _with_payload(self, mass: float, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        body, place = _tip(self.model, self.body)
        kept = (
            float(self.model.body_mass[body]),
            self.model.body_ipos[body].copy(),
            self.model.body_inertia[body].copy(),
            self.model.body_iquat[body].copy(),
        )
        try:
            _add_point(self.model, body, place, mass)
            mujoco.mj_setConst(self.model, self.data)
            return self._inverse(q, v, a)
        finally:
            self.model.body_mass[body] = kept[0]
            self.model.body_ipos[body], self.model.body_inertia[body] = kept[1], kept[2]
            self.model.body_iquat[body] = kept[3]
            mujoco.mj_setConst(self.model, self.data)

    def _stiffness(self) -> float:
        joint = int(self.model.dof_jntid[self._driven])
        return float(np.atleast_1d(self.model.jnt_stiffness[joint])[0])


def _lever(model: mujoco.MjModel, data: mujoco.MjData, tendon: int, dof: int) -> float:
    dense = np.zeros((model.ntendon, model.nv))
    if data.ten_J.size == dense.size:
        dense = data.ten_J.reshape(dense.shape)
    else:
        mujoco.mju_sparse2dense(
            dense, data.ten_J, model.ten_J_rownnz, model.ten_J_rowadr, model.ten_J_colind
        )
    return float(dense[tendon, dof])


def _tip(model: mujoco.MjModel, body: Body) -> tuple[int, np.ndarray]:
    """The body that carries a payload, and where in its frame."""
    site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, body.tip or "")
    if site >= 0:
        return int(model.site_bodyid[site]), model.site_pos[site].copy()
    found = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body.tip or "")
    if found < 0:
        raise ConfigError(f"{body.mjcf}: no site or body '{body.tip}' to carry a payload")
    return found, np.zeros(3)


def _add_point(model: mujoco.MjModel, body: int, place: np.ndarray, mass: float) -> None:
    """Merge a point mass into a body's inertia."""
    own, centre = float(model.body_mass[body]), model.body_ipos[body].copy()
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[body])
    frame = turn.reshape(3, 3)
    inertia = frame @ np.diag(model.body_inertia[body]) @ frame.T
    whole = own + mass
    middle = (own * centre + mass * place) / whole
    for weight, point in ((own, centre), (mass, place)):
        d = point - middle
        inertia += weight * (np.dot(d, d) * np.eye(3) - np.outer(d, d))
    values, vectors = np.linalg.eigh(inertia)
    if np.linalg.det(vectors) < 0:
        vectors[:, 0] *= -1
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, vectors.ravel())
    model.body_mass[body], model.body_ipos[body] = whole, middle
    model.body_inertia[body], model.body_iquat[body] = values, quaternion
