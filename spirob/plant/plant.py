"""The model as a whole: numbers, effects and the compiled loop behind one method, `simulate`.

Beside it the baseline, `single_dynamics`: the robot's dynamics alone, without motor, winch or
elastic tendon.  The commanded tendon forces act on the body in the cycle in which they are
commanded (paper eq. continuumdynamics with F = F_cmd), so it answers at once where the coupled
model lags.
"""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import mujoco
import numpy as np

from spirob.can_protocol import VOLT_PER_COUNT
from spirob.control import Schedule
from spirob.effects import Effect
from spirob.effects.effect import differences
from spirob.errors import SimulationError
from spirob.parameter import Parameter, Table
from spirob.plant.assemble import assemble, law_numbers, memory_rows
from spirob.plant.body import build_spec, compiled, launch
from spirob.plant.records import SETTINGS, Frames, Layout, Response, made
from spirob.plant.rig import Arm, Holes, Rig
from spirob.plant.session import CYCLE, Session, Torque
from spirob.plant.tendon import room
from spirob.ports import PORTS
from spirob.robot import MOTORS, Scene

SUBSTEPS = 2  # 0.5 ms: converged to 1 % against 25 µs, and the arm is stable to 100 N


class Plant:
    """A rig with a list of effects; safe to use from several threads at once.

    substeps  MuJoCo steps in a cycle of 1 ms
    table     its numbers by name;  layout  how the compiled loop `run` has them
    settings  the controller's numbers;  begun  what effects remember at first
    scatter   factors of the hinges' stiffness, as bytes; none where there are none
    off       how far each hole lies from its place, `scattered`; None where none does
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
        of_laws = {name for e in self.effects for name in law_numbers([e])}
        self.layout = Layout(self.table.names, without=of_laws)
        looped = [e for e in self.effects if PORTS[e.port].every != "once"]
        self.numbers = [self.table.position(name) for name in law_numbers(looped)]
        self.run = assemble(looped, rig.host is not None)
        self.begun = np.array([e.state[s] for e, s in memory_rows(self.effects)])
        self.settings = self._controller()
        self.scatter: bytes = b""
        self.off: np.ndarray | None = None

    def coarse(self) -> "Plant":
        """The same machine in one step a cycle: half the price, 0.3 % of the current away."""
        found = copy.copy(self)
        found.substeps = 1
        return found

    def scattered(self, factors: np.ndarray, off: np.ndarray | None = None) -> "Plant":
        """The same machine, stiffness and damping of each hinge so many times as large, (N,).

        off  how far the holes lie from their places, along the arm and outwards, over the size of
             their unit [m], (2, N + 1, 2): of the left side, then the right; the mount's first
        """
        found = copy.copy(self)
        found.scatter = np.asarray(factors, dtype=float).tobytes()
        found.off = off
        return found

    def reading(self, frames: Frames) -> "Plant":
        """The same machine, its loop on the host reading counts; a drive's own loop reads none."""
        found = copy.copy(self)
        found.settings = self.settings.copy()
        told = found.settings[0]
        told.host_current_count, told.host_speed_count = frames.current, frames.speed
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
        noise: np.ndarray | None = None,
    ) -> Response:
        """Play a schedule from rest; `changes` replaces parameters by name, `owner.field`.

        The tendons are off before, or hold the arm where the schedule says so.

        first_angle  of the rotors [rad], for what depends on where in a turn they stand
        noise        (T, 2) of the current that a loop on the host reads [A]; None: none

        Deterministic: the same arguments give the same bits.  Raises SimulationError naming the
        cycle when a state becomes non-finite, ConfigError on an unknown parameter.
        """
        session = self.start(scene, changes, first_angle)
        if schedule.held is not None:
            session.settle(schedule.held)
        whole = session.play(schedule, noise)
        return Response(*(getattr(whole, f.name)[:-1] for f in fields(Response)))

    def start(
        self,
        scene: Scene,
        changes: Mapping[str, float] | None = None,
        first_angle: Sequence[float] | np.ndarray = (0.0, 0.0),
    ) -> Session:
        """The model at rest as it hangs, tendons just taut, to be played piece by piece."""
        session = Session(self, scene, self.table.vector(changes))
        session.state.first_angle = first_angle  # where in a turn the rotors stand [rad]
        return session

    def _controller(self) -> np.ndarray:
        """The controller's numbers; those of the host's loop where there is one."""
        settings, gains, placed = made(SETTINGS), self.rig.gains, self.rig.placed()
        for name in gains.parameters():
            settings[name] = getattr(gains, name)
        settings["radius"] = self.rig.winch.radius
        if self.rig.host is None or placed is None:
            return settings
        motor, drive = self.rig.motor, self.rig.drive
        told = settings[0]
        told.host_resistance, told.host_inductance = motor.resistance, motor.inductance
        told.host_emf = drive.emf_compensation * motor.emf_constant
        told.host_proportional, told.host_integral, told.host_derivative = placed.gains
        told.host_limit, told.host_latency = drive.voltage_limit, self.rig.host.latency / CYCLE
        told.host_count = VOLT_PER_COUNT
        return settings

    def arm(self, p: np.ndarray) -> Arm:
        """The numbers of the arm in a vector of the table."""
        names = Arm.parameters()
        return Arm(**{f: float(p[self.table.position(f"arm.{f}")]) for f in names})

    def compiled(
        self, p: np.ndarray, scene: Scene, timestep: float, tip_mass: float
    ) -> mujoco.MjModel:
        """The arm in a scene as MuJoCo has it; timestep [s], tip_mass [kg]."""
        shape = self.rig.geometry, self.rig.units
        return compiled(self.arm(p), scene, shape, timestep, tip_mass, self.scatter)

    def holes(self, p: np.ndarray) -> Holes:
        """Those of the tendons' holes."""
        names = Holes.parameters()
        return Holes(**{f: float(p[self.table.position(f"holes.{f}")]) for f in names})

    def tip_mass(self, p: np.ndarray) -> float:
        """What the effects carry at the tip [kg]."""
        at_tip = [e for e in self.effects if e.port == "body.tip_mass"]
        values = [
            {f: p[self.table.position(f"{e.name()}.{f}")] for f in e.parameters()} for e in at_tip
        ]
        return float(sum(e.kernel(**v) for e, v in zip(at_tip, values, strict=True)))

    def resting_torques(self, p: np.ndarray) -> tuple[Torque, ...]:
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


@dataclass(frozen=True)
class Motion:
    """What the arm did; row k is the state at the start of cycle k.

    shortening       (T, 2) Δl of the left and right tendon [m];  shortening_rate [m/s]
    angles           (T, N) hinge angles [rad]
    """

    shortening: np.ndarray
    shortening_rate: np.ndarray
    angles: np.ndarray


def single_dynamics(rig: Rig, force: np.ndarray, scene: Scene | None = None) -> Motion:
    """Pull the arm with commanded tendon forces, from rest.

    force  (T, 2) [N] of the left and right tendon, one row for each 1 kHz cycle; a negative one
           counts as zero, because a tendon does not push
    Raises SimulationError naming the time at which a state becomes non-finite.
    """
    step = CYCLE / SUBSTEPS
    spec = build_spec(rig.arm, scene or Scene(), rig.lengths(), step, True, holes=rig.holes)
    model = spec.compile()
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    data = mujoco.MjData(model)
    launch(data, scene or Scene(), rig.units)
    mujoco.mj_forward(model, data)
    rest = data.ten_length.copy()
    cycles = len(force)
    shortening, rate = np.zeros((cycles, len(MOTORS))), np.zeros((cycles, len(MOTORS)))
    angles = np.zeros((cycles, rig.units))
    for k in range(cycles):
        shortening[k], rate[k] = rest - data.ten_length, -data.ten_velocity
        angles[k] = data.qpos[: rig.units]
        data.ctrl[:] = np.maximum(force[k], 0.0)
        mujoco.mj_step(model, data, nstep=SUBSTEPS)
        # lengths belong to the step's beginning; bring them to its end
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        if not np.isfinite(data.qvel).all():
            raise SimulationError(f"the arm became non-finite after {k * CYCLE:.3f} s")
    return Motion(shortening, rate, angles)
