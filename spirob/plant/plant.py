"""The model as a whole: numbers, effects and the compiled loop behind one method, `simulate`."""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import lru_cache

import mujoco
import numpy as np

from spirob.control.law import CURRENT, Schedule
from spirob.drives.codec import VOLT_PER_COUNT
from spirob.effects import Effect
from spirob.effects.effect import differences
from spirob.errors import SimulationError
from spirob.parameter import Parameter, Table
from spirob.plant.assemble import assemble, memory_rows
from spirob.plant.body import Shape, compiled
from spirob.plant.chain import chain_of
from spirob.plant.objects import bow, launch, outlines
from spirob.plant.rest import Torque, rest_pose
from spirob.plant.rig import Arm, Holes, Rig
from spirob.plant.tendon import guides, room, shortenings, with_holes
from spirob.robot import CYCLE_NS, Scene, Weights

CYCLE = CYCLE_NS * 1e-9
SUBSTEPS = 2  # 0.5 ms: converged to 1 % against 25 µs, and the arm is stable to 100 N
STATE_ROWS = 26  # see `loop.run`; the last five of a loop on the host
# rows of it that a trial begins with
DISPLACEMENT, RATE, TURNED, SHORTENING, BEGUN, FIRST_ANGLE, HUNG = 3, 4, 5, 7, 15, 18, 19
SETTLING = 1000  # cycles in which the arm comes to rest under currents, half of them to raise these
LIGHT = {  # rotors that hardly slow it
    "motor.rotor_inertia": 1e-7,
    "motor.rotor_damping": 1e-6,
    "winch.drum_inertia": 0.0,
}
SLOTS = 6  # of a motor's memory: two motors, and up to three signals that pass one port
COLUMNS = (
    "current",
    "arm_current",
    "displacement",
    "velocity",
    "shortening",
    "shortening_rate",
    "tension",
    "command",
    "voltage",
)


@dataclass(frozen=True)
class Response:
    """What the model did, one row for each 1 kHz cycle; columns of the (T, 2) arrays: left, right.

    current          i* as the drive reports it [A]
    arm_current      i**, reconstructed from the arm's motion and the tension it feels [A]
    displacement     wound-in length as the encoder reports it [m];  velocity  its rate [m/s]
    shortening       Δl of the tendon [m];  shortening_rate [m/s]
    tension          [N];  command  commanded current [A]
    voltage          that the host sends [V]; zero where the drive closes the current loop
    angles           (T, N) hinge angles [rad]
    """

    current: np.ndarray
    arm_current: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    shortening: np.ndarray
    shortening_rate: np.ndarray
    tension: np.ndarray
    command: np.ndarray
    voltage: np.ndarray
    angles: np.ndarray


class Plant:
    """A rig with a list of effects; safe to use from several threads at once.

    substeps  MuJoCo steps in a cycle of 1 ms
    """

    def __init__(self, rig: Rig, effects: Sequence[type[Effect]] = (), substeps: int = SUBSTEPS):
        self.rig = rig
        self.effects = list(effects)
        self.substeps = substeps
        owners = [*rig.parts(), *((e.name(), e(**e.neutral)) for e in self.effects)]
        own = {f"{e.name()}.{f}": a for e in effects for f, a in differences(e).items()}
        self.table = Table(owners).joined(own).behind(rig.winch.gear_ratio)
        self.table = self.table.narrowed(room(rig.geometry.arm()))
        self.geometry = rig.lengths()
        self._run = assemble(self.effects, self.table.names, rig.host is not None)
        self._states = np.array([e.state[s] for e, s in memory_rows(self.effects)])
        self._scatter: bytes = b""

    def coarse(self) -> "Plant":
        """The same machine in one step a cycle: half the price, 0.3 % of the current away."""
        found = copy.copy(self)
        found.substeps = 1
        return found

    def scattered(self, factors: np.ndarray) -> "Plant":
        """The same machine, stiffness and damping of each hinge so many times as large, (N,)."""
        found = copy.copy(self)
        found._scatter = np.asarray(factors, dtype=float).tobytes()
        return found

    def within(self, about: Mapping[str, Parameter]) -> "Plant":
        """The same machine with something else known of some numbers, which stand at nominal."""
        found = copy.copy(self)
        found.table = self.table.within(about)
        return found

    def simulate(
        self,
        schedule: Schedule,
        scene: Scene,
        changes: Mapping[str, float] | None = None,
        first_angle: Sequence[float] | np.ndarray = (0.0, 0.0),
    ) -> Response:
        """Play a schedule from rest; `changes` replaces parameters by name, `owner.field`.

        The tendons are off before, or hold the arm where the schedule says so.

        first_angle  of the rotors [rad], for what depends on where in a turn they stand

        Deterministic: the same arguments give the same bits.  Raises SimulationError naming the
        cycle when a state becomes non-finite, ConfigError on an unknown parameter.
        """
        session = self.start(scene, changes, first_angle)
        if schedule.held is not None:
            session.settle(schedule.held)
        whole = session.play(schedule)
        return Response(*(getattr(whole, f.name)[:-1] for f in fields(Response)))

    def start(
        self,
        scene: Scene,
        changes: Mapping[str, float] | None = None,
        first_angle: Sequence[float] | np.ndarray = (0.0, 0.0),
    ) -> "Session":
        """The model at rest as it hangs, tendons just taut, to be played piece by piece."""
        session = Session(self, scene, self.table.vector(changes))
        session.rotors_at(first_angle)
        return session

    def _gains(self) -> np.ndarray:
        g = self.rig.gains
        law = [g.velocity, g.integral, g.displacement, g.force, g.newton_per_ampere, g.drag]
        return np.array([*law, 0.0, self.rig.winch.radius, *self._host()])

    def _host(self) -> tuple[float, ...]:
        """What the host believes of the winding; gains, limit [V], latency [cycles], count [V]."""
        host, placed, motor = self.rig.host, self.rig.placed(), self.rig.motor
        if host is None or placed is None:
            return ()
        emf = self.rig.drive.emf_compensation * motor.emf_constant
        believed = motor.resistance, motor.inductance, emf
        more = self.rig.drive.voltage_limit, host.latency / CYCLE, VOLT_PER_COUNT
        return *believed, *placed.gains, *more

    def _arm(self, p: np.ndarray) -> Arm:
        names = Arm.parameters()
        return Arm(**{f: float(p[self.table.position(f"arm.{f}")]) for f in names})

    def _compiled(
        self, p: np.ndarray, scene: Scene, timestep: float, tip_mass: float
    ) -> mujoco.MjModel:
        shape: Shape = self.rig.geometry, self.rig.units
        return compiled(self._arm(p), scene, shape, timestep, tip_mass, self._scatter)

    def _holes(self, p: np.ndarray) -> Holes:
        names = Holes.parameters()
        return Holes(**{f: float(p[self.table.position(f"holes.{f}")]) for f in names})

    def _at_tip(self, p: np.ndarray) -> float:
        at_tip = [e for e in self.effects if e.port == "body.tip_mass"]
        values = [
            {f: p[self.table.position(f"{e.name()}.{f}")] for f in e.parameters()} for e in at_tip
        ]
        return float(sum(e.kernel(**v) for e, v in zip(at_tip, values, strict=True)))

    def _at_hinges(self, p: np.ndarray) -> tuple[Torque, ...]:
        """What turns the hinges of a resting arm, with its numbers."""
        found: list[Torque] = []
        for e in self.effects:
            if e.port == "body.hinge_torque" and not e.state:
                values = {
                    f: float(p[self.table.position(f"{e.name()}.{f}")]) for f in e.parameters()
                }
                if any(values[f] != neutral for f, neutral in e.neutral.items()):
                    found.append((e, tuple(values.items())))
        return tuple(found)


class Session:
    """A plant in motion: each `play` goes on where the one before it stopped."""

    def __init__(self, plant: Plant, scene: Scene, p: np.ndarray):
        self._plant, self._p = plant, p
        hinges = plant.rig.units
        self._step = CYCLE / plant.substeps
        tip_mass = plant._at_tip(p)
        model = plant._compiled(p, scene, self._step, tip_mass)
        bends = float(p[plant.table.position("arm.bends_per_hinge")])
        self._outline = outlines(model, hinges)
        self._heights = model.geom_pos[self._outline, 1]
        self._bows = np.zeros(hinges)
        if scene.touchable and bends > 1.0:
            model = copy.copy(model)  # its outline moves, out of the boxes drawn round it
            model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_MIDPHASE
            self._bows = bow(plant.geometry, bends)
        self._model, self._data = model, mujoco.MjData(model)
        launch(self._data, scene, hinges)
        chain = chain_of(model, hinges, self._outline, self._bows)
        self._chain = chain[:, :0] if scene.ball or scene.peg else chain  # MuJoCo has to move them
        post = scene.cylinder
        self._post = np.array([post.x, post.y, post.diameter / 2] if post else [0.0, 0.0, 0.0])
        springs = model.jnt_stiffness.reshape(model.njnt, -1)[:hinges, 0]
        self._stiffness = np.ascontiguousarray(springs)
        mass = np.append(model.body_mass[1 : hinges + 1], tip_mass)
        self._units = np.column_stack([mass, np.append(plant.geometry.unit_length, 0.0)])
        self._guides = guides(with_holes(plant.geometry, plant._holes(p)), bends)
        self._columns = np.ascontiguousarray(self._guides.T)
        self._state = np.zeros((STATE_ROWS, 2))
        self._hang(tip_mass)
        weights = scene.weights or Weights()
        self._state[HUNG] = weights.left, weights.right
        self._memory = np.repeat(plant._states[:, None], max(2 * hinges, SLOTS), axis=1)
        # a ball or a peg has coordinates behind the hinges, on which no tendon pulls
        self._pull, self._solved = np.zeros((2, model.nv)), np.zeros((2, model.nv))
        drive_rate = p[plant.table.position("drive.rate")]
        self._drive_steps = max(1, round(self._step * drive_rate))

    def _hang(self, tip_mass: float) -> None:
        """Put the arm where it hangs by itself, tendons just taut."""
        plant, p = self._plant, self._p
        arm, hinges = plant._arm(p), plant.rig.units
        torques = plant._at_hinges(p)
        if not (torques or arm.gravity_x or arm.gravity_y):
            return
        bare = plant._compiled(p, Scene(), self._step, tip_mass)
        # every trial of an evaluation begins alike
        pose = _pose(bare, self._units.tobytes(), self._stiffness.tobytes(), torques)
        self._data.qpos[:hinges] = pose
        taken_up = shortenings(pose, self._guides)
        self._state[DISPLACEMENT] = self._state[SHORTENING] = taken_up

    def rotors_at(self, angle: Sequence[float] | np.ndarray) -> None:
        """Say where in a turn the rotors stand at the start [rad]."""
        self._state[FIRST_ANGLE] = angle

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
        self._state[[RATE, TURNED, BEGUN]] = 0.0
        self._data.qvel[:] = 0.0
        for row, (effect, _) in enumerate(memory_rows(self._plant.effects)):
            if effect.port == "sensing.frame":
                self._memory[row, :2] = 0.0  # of the lengths, which pass this port first

    def constants(self) -> dict[str, np.ndarray]:
        """What the loop is given beside the schedule, by its argument's name, as it begins."""
        return {
            "qpos": self._data.qpos.copy(),
            "p": self._p.copy(),
            "gains": self._plant._gains(),
            "guides": self._columns,
            "units": self._units,
            "gravity": self._model.opt.gravity.copy(),
            "stiffness": self._stiffness,
            "drive_steps": np.array(self._drive_steps),
            "state": self._state.copy(),
            "memory": self._memory.copy(),
        }

    def play(self, schedule: Schedule) -> Response:
        """Play a schedule; the response has one row more than it, the state at its end."""
        rows, hinges = schedule.cycles + 1, self._plant.rig.units
        out = np.zeros((rows, 2, len(COLUMNS)))
        angles = np.zeros((rows, hinges))
        model, data = self._model, self._data
        failed = self._plant._run(
            model._address,
            data._address,
            data.qpos,
            data.qvel,
            data.qfrc_applied,
            self._p,
            np.asarray(schedule.mode, dtype=np.int64),
            np.ascontiguousarray(schedule.reference, dtype=float),
            np.ascontiguousarray(schedule.reference_rate, dtype=float),
            np.asarray(schedule.current_limit, dtype=float),
            self._plant._gains(),
            self._columns,
            self._units,
            self._bows,
            self._heights,
            self._outline,
            model.geom_pos,
            self._chain,
            self._post,
            model.opt.gravity,
            self._stiffness,
            self._plant.substeps,
            self._step,
            self._drive_steps,
            self._state,
            self._memory,
            self._pull,
            self._pull.ctypes.data,
            self._solved,
            self._solved.ctypes.data,
            out,
            angles,
        )
        if failed >= 0:
            raise SimulationError(f"the model became non-finite after {failed * CYCLE:.3f} s")
        return Response(**{c: out[:, :, k] for k, c in enumerate(COLUMNS)}, angles=angles)


@lru_cache(maxsize=64)
def _pose(
    model: mujoco.MjModel, units: bytes, stiffness: bytes, torques: tuple[Torque, ...]
) -> np.ndarray:
    sizes = np.frombuffer(units).reshape(-1, 2)
    return rest_pose(model, sizes, np.frombuffer(stiffness), torques)
