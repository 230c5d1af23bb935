"""A plant in motion, and where its arm hangs before a trial.

Before a trial the arm hangs at rest, tendons off.  Lengths count from there, as the tendons of a
robot are taken up on the arm as it hangs.  A weight across the arm or a bend of its own moves that
pose by many degrees: begun straight, a trial would open with a swing that no robot makes.  The pose
is found by letting the calm arm relax, its hinges damped far more than they are, against end stops
and against itself.
"""

import copy
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from spirob.control import CURRENT, Schedule
from spirob.effects import Effect
from spirob.errors import SimulationError
from spirob.plant.assemble import Laws, memory_rows
from spirob.plant.body import hinge_weights, launch
from spirob.plant.chain import bow, chain_of, outlines
from spirob.plant.records import (
    COLUMNS,
    NOISE,
    PASSING,
    ROW,
    STATE,
    Moved,
    Response,
    arm_kind,
    made,
)
from spirob.plant.tendon import guides, scattered, shortenings, with_holes
from spirob.robot import CYCLE_NS, Scene, Weights

if TYPE_CHECKING:
    from spirob.plant.plant import Plant

DAMPING = 0.6  # s, over the stiffness: the slowest mode of the arm is then nearly critical
STEP = 4e-3  # s
ROUND = 25  # steps between two looks at the effects' torques
ROUNDS = 100  # at most: 10 s
STILL = 1e-9  # rad/s

# an effect's kernel with its numbers
Torque = tuple[type[Effect], tuple[tuple[str, float], ...]]


def rest_pose(
    model: mujoco.MjModel, units: np.ndarray, stiffness: np.ndarray, torques: Sequence[Torque]
) -> np.ndarray:
    """Angles of the hinges at rest [rad], (N,).

    model      of the arm without anything to touch
    units      (N + 1, 2) mass [kg] and length [m] of each unit, the mass at the tip last
    stiffness  of the hinges [N·m/rad], (N,)
    torques    effects that turn hinges, without memory
    """
    hinges = len(stiffness)
    calm = copy.copy(model)
    calm.opt.timestep = STEP
    calm.dof_damping[:hinges] = DAMPING * stiffness
    data = mujoco.MjData(calm)
    weight = np.zeros((hinges, 2))
    for _ in range(ROUNDS):
        hinge_weights(data.qpos, units, weight)
        signals = {
            "hinge.angle": data.qpos,
            "hinge.speed": np.zeros(hinges),
            "hinge.stiffness": stiffness,
            "hinge.weight_x": weight[:, 0],
            "hinge.weight_y": weight[:, 1],
        }
        data.qfrc_applied[:hinges] = sum(_torque(t, signals, hinges) for t in torques)
        mujoco.mj_step(calm, data, ROUND)
        if np.abs(data.qvel).max() < STILL:
            break
    return np.array(data.qpos[:hinges])


def _torque(torque: Torque, signals: dict[str, np.ndarray], hinges: int) -> np.ndarray:
    effect, numbers = torque
    values = dict(numbers)
    return np.array(
        [
            effect.kernel(**{a: signals[s][i] for a, s in effect.reads.items()}, **values)
            for i in range(hinges)
        ]
    )


CYCLE = CYCLE_NS * 1e-9
SLOTS = 6  # of a motor's memory: two motors, and up to three signals that pass one port
SETTLING = 1000  # cycles in which the arm comes to rest under currents, half of them to raise these
LIGHT = {  # rotors that hardly slow it
    "motor.rotor_inertia": 1e-7,
    "motor.rotor_damping": 1e-6,
    "winch.drum_inertia": 0.0,
}


class Session:
    """A plant in motion: each `play` goes on where the one before it stopped.

    state, arm  what the compiled loop works on (`plant.records`)
    memory  of the effects, a row for each state of `memory_rows`
    """

    def __init__(self, plant: "Plant", scene: Scene, p: np.ndarray):
        self._plant, self._p = plant, p
        hinges = plant.rig.units
        self._step = CYCLE / plant.substeps
        self._settings, self._passing = plant.settings.copy(), made(PASSING)
        self._settings["substeps"], self._settings["step"] = plant.substeps, self._step
        self._settings["cycle"] = plant.substeps * self._step
        drive_rate = p[plant.table.position("drive.rate")]
        self._settings["drive_steps"] = max(1, round(self._step * drive_rate))
        self._state, self._arm = made(STATE), made(arm_kind(hinges))
        self.state, self.arm = self._state[0], self._arm[0]
        self.memory = np.repeat(plant.begun[:, None], max(2 * hinges, SLOTS), axis=1)
        tip_mass = plant.tip_mass(p)
        self._model = plant.compiled(p, scene, self._step, tip_mass)
        bends = float(p[plant.table.position("arm.bends_per_hinge")])
        run = with_holes(plant.geometry, plant.holes(p))
        sides = [run, run] if plant.off is None else [scattered(run, off) for off in plant.off]
        self._guides = [guides(side, bends) for side in sides]
        self._describe(scene, bends, tip_mass)
        self._data = mujoco.MjData(self._model)
        launch(self._data, scene, hinges)
        self._moved = self._moves()
        self._hang(tip_mass)
        weights = scene.weights or Weights()
        self.state.hung = weights.left, weights.right

    def _describe(self, scene: Scene, bends: float, tip_mass: float) -> None:
        """Fill the arm's record."""
        plant, arm, model, hinges = self._plant, self.arm, self._model, self._plant.rig.units
        arm.outline = outlines(model, hinges)
        arm.heights = model.geom_pos[arm.outline, 1]
        if scene.touchable and bends > 1.0:
            model = self._model = copy.copy(model)
            # its outline moves, out of the boxes drawn round it
            model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_MIDPHASE
            arm.bows = bow(plant.geometry, bends)
        arm.chain = chain_of(model, hinges, arm.outline, arm.bows)
        arm.alone = not (scene.ball or scene.peg)  # MuJoCo has to move these
        arm.gravity = model.opt.gravity[:2]
        if scene.cylinder:
            arm.post = scene.cylinder.x, scene.cylinder.y, scene.cylinder.diameter / 2
        arm.stiffness = model.jnt_stiffness.reshape(model.njnt, -1)[:hinges, 0]
        arm.units[:, 0] = np.append(model.body_mass[1 : hinges + 1], tip_mass)
        arm.units[:hinges, 1] = plant.geometry.unit_length
        arm.guides = np.hstack(self._guides).T

    def _moves(self) -> Moved:
        model, data = self._model, self._data
        pull, solved = self.arm.pull, self.arm.solved
        assert model.nv <= pull.shape[1], "MuJoCo would write beyond the rows"
        first, row = (pull.ctypes.data, solved.ctypes.data), pull.strides[0]
        return Moved(
            model._address,
            data._address,
            data.qpos,
            data.qvel,
            data.qfrc_applied,
            model.geom_pos,
            (first[0], first[0] + row),
            (first[1], first[1] + row),
        )

    def _hang(self, tip_mass: float) -> None:
        """Put the arm where it hangs by itself, tendons just taut."""
        plant, p = self._plant, self._p
        arm, hinges = plant.arm(p), plant.rig.units
        torques = plant.resting_torques(p)
        if not (torques or arm.gravity_x or arm.gravity_y):
            return
        bare = plant.compiled(p, Scene(), self._step, tip_mass)
        # every trial of an evaluation begins alike
        units, stiffness = self.arm.units, self.arm.stiffness
        pose = _pose(bare, units.tobytes(), stiffness.tobytes(), torques)
        self._data.qpos[:hinges] = pose
        self.state.displacement = self.state.shortening = shortenings(pose, *self._guides)

    def settle(self, currents: np.ndarray) -> None:
        """Let the arm come to rest under constant currents (2,) [A]; lengths count from there.

        The rotors are next to weightless meanwhile, which leaves the place of rest where it is.
        """
        heavy, self._p = self._p, self._p.copy()
        for name, value in LIGHT.items():
            self._p[self._plant.table.position(name)] = value
        rising = np.minimum(np.linspace(0.0, 2.0, SETTLING), 1.0)[:, None] * currents
        modes = np.full(2, CURRENT)
        self.play(Schedule(modes, rising, np.zeros_like(rising), np.abs(currents)))
        self._p = heavy
        self.state.rate = self.state.turned = self.state.cycle = 0.0
        self._data.qvel[:] = 0.0
        for row, (effect, _) in enumerate(memory_rows(self._plant.effects)):
            if effect.port == "sensing.frame":
                self.memory[row, :2] = 0.0  # of the lengths, which pass this port first

    def constants(self) -> dict[str, np.ndarray]:
        """What the loop is given beside the schedule, by its argument's name, as it begins."""
        return {
            "p": self._p.copy(),
            "state": self._state[0].copy(),
            "passing": self._passing[0].copy(),
            "settings": self._settings[0].copy(),
            "arm": self._arm[0].copy(),
            "memory": self.memory.copy(),
            "qpos": self._data.qpos.copy(),
        }

    def play(self, schedule: Schedule, noise: np.ndarray | None = None) -> Response:
        """Play a schedule; the response has one row more than it, the state at its end.

        noise  (T, 2) of the current that the host's loop reads [A]; None: none
        """
        rows = schedule.cycles + 1
        out = np.zeros((rows, 2), ROW)
        if noise is not None:
            out[NOISE][:-1] = noise
        angles = np.zeros((rows, self._plant.rig.units))
        self._settings["mode"], self._settings["limit"] = schedule.mode, schedule.current_limit
        failed = self._plant.run(
            self._plant.layout.of(self._p),
            self._state,
            self._passing,
            self._settings,
            self._arm,
            self._moved,
            Laws(self._p[self._plant.numbers], self.memory),
            np.ascontiguousarray(schedule.reference, dtype=float),
            np.ascontiguousarray(schedule.reference_rate, dtype=float),
            out,
            angles,
        )
        if failed >= 0:
            raise SimulationError(f"the model became non-finite after {failed * CYCLE:.3f} s")
        return Response(**{name: out[name] for name in COLUMNS}, angles=angles)


@lru_cache(maxsize=64)
def _pose(
    model: mujoco.MjModel, units: bytes, stiffness: bytes, torques: tuple[Torque, ...]
) -> np.ndarray:
    sizes = np.frombuffer(units).reshape(-1, 2)
    return rest_pose(model, sizes, np.frombuffer(stiffness), torques)
