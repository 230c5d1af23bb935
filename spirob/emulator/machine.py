"""The machine itself, without a bus: state, trials and cycles, and how long its bus takes.

A trial starts from the same rest whatever came before, and its noise depends on nothing but the
seed and the trial's name, so trials can run in any order and in parallel.

A machine in voltage mode counts how long its bus takes, up for a reading and down for a command.
What the host reads is from the end of a cycle; the voltage that follows from it acts about a cycle
later.  How much later differs from machine to machine, and a little from frame to frame.
"""

import zlib
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.random import Generator

from spirob.emulator import hidden
from spirob.emulator.build import built
from spirob.emulator.physics import HINGES
from spirob.emulator.physics.step import SCRATCH, STATE, run_cycle
from spirob.emulator.rig import EmulatedRig, HiddenSettings, draw, numbers_of
from spirob.errors import ConfigError, HardwareError
from spirob.robot import CYCLE_NS, MOTORS, Scene, Weights

CYCLE = CYCLE_NS * 1e-9
MEAN = (0.7e-3, 1.3e-3)  # s, drawn for a machine: adapters, and drives with clocks of their own
JITTER = 0.1e-3  # s, either way, for each frame; less than half a cycle, so that order is kept
BLOCK = 1000  # frames whose jitter is drawn at once


class BusLatency:
    """Voltages on their way to the drives.

    mean  latency of this machine [s]
    """

    def __init__(self, machine: Generator):
        self.mean = float(machine.uniform(*MEAN))
        self._waiting: list[tuple[float, tuple[float, ...]]] = []

    def begin(self, trial: Generator) -> None:
        """A new trial: nothing is on its way."""
        self._source = trial
        self._jitter: list[float] = []
        self._waiting = []

    def arrivals(self, volts: Sequence[float]) -> list[tuple[float, tuple[float, ...]]]:
        """Send voltages at the start of a cycle; what comes within it: when [s], and what [V]."""
        if not self._jitter:
            self._jitter = self._source.uniform(-JITTER, JITTER, BLOCK).tolist()
        self._waiting.append((self.mean + self._jitter.pop(), tuple(volts)))
        come = [(at, v) for at, v in self._waiting if at < CYCLE * (1 - 1e-9)]
        later = self._waiting[len(come) :]
        self._waiting = [(max(0.0, at - CYCLE), v) for at, v in later]
        return come


def written(scratch: np.ndarray, come: Sequence[tuple[float, tuple[float, ...]]]) -> None:
    """Write down for the compiled step what comes in the next cycle."""
    scratch["coming"][0] = len(come)
    for k, (at, volts) in enumerate(come):
        scratch["comes_at"][0, k] = at
        scratch["coming_volts"][0, k] = volts


NOISE_BLOCK = 1000  # cycles whose noise is drawn at once
SETTLE_STEPS = 15000
SETTLE_STEP = 0.002  # s
SETTLE_DAMPING = 10.0  # times the arm's own, while it comes to rest


class Machine:
    """One emulated machine.

    rig, settings  what was asked for
    drawn          its data sheet, of which `build` is what was built
    numbers        the record of its true numbers, hidden effects included
    hidden         what each hidden effect changed
    state          the record of its present state
    latency        of the voltages that the host sends; None where drives take currents
    """

    def __init__(self, rig: EmulatedRig, settings: HiddenSettings, seed: int):
        self.rig = rig
        self.settings = settings
        self.seed = seed
        self.dt = CYCLE / rig.steps_per_cycle
        self.drawn = draw(self.generator("machine"))
        arm = rig.geometry.arm(HINGES)
        self.build = built(settings.build, arm, self.drawn, self.generator("build", settings.built))
        self.numbers = numbers_of(rig, self.build, self.dt)
        self.hidden = hidden.apply(settings, self.generator, self.numbers)
        self.state = np.zeros(1, STATE)
        self.latency = BusLatency(self.generator("bus")) if rig.by_voltage else None
        self.counts = np.zeros((2, 4), dtype=np.int64)
        self._scratch = np.zeros(1, SCRATCH)
        self.start(Scene(), "trial")

    def move(self, factors: Mapping[str, np.ndarray]) -> None:
        """Multiply true numbers, by their names in the record, before a trial is started.

        factors  one for all, or (2,) for left and right where the record tells them apart
        """
        for name, factor in factors.items():
            number, sides = self.numbers[name][0], np.broadcast_to(factor, len(MOTORS))
            apart = np.shape(number)[:1] == sides.shape
            own = sides.reshape(-1, *[1] * (np.ndim(number) - 1)) if apart else sides.mean()
            self.numbers[name][0] = number * own

    def start(self, scene: Scene, trial: str) -> None:
        """Bring the machine to rest in a scene, tendons just taut, currents zero."""
        self._trial = trial
        self._noise_source = self.generator(f"trial {trial}")
        rotors = self._noise_source.uniform(0.0, 2 * np.pi, size=2)
        self._noise = np.empty((0, 2))
        self._cycle = 0
        written(self._scratch, [])
        if self.latency:
            self.latency.begin(self.generator(f"bus in trial {trial}"))
        self._place(scene)
        self.state = np.zeros(1, STATE)
        self.state["phi"][0] = np.cumsum(self.numbers["rest_angle"][0])
        self.state["object"][0, :2] = self._first[:2]
        self._settle()
        self.state["rotor_angle"][0] = rotors
        self.state["rotor_start"][0] = rotors
        self._advance(self.numbers, np.zeros(2), steps=0)
        if self._scratch["depth"][0] > 1e-4:
            raise ConfigError(
                f"trial '{trial}': the object overlaps the resting arm by "
                f"{1e3 * self._scratch['depth'][0]:.1f} mm; move it away from the arm"
            )

    def cycle(self, currents: tuple[float, ...]) -> np.ndarray:
        """Hold the commanded currents [A] for 1 ms; returns the counts of the feedback (2, 4).

        In voltage mode they are voltages [V], which act when the bus has brought them.
        Raises HardwareError when the state is lost; the machine must then be started anew.
        """
        if self._cycle == len(self._noise):
            self._noise = self._noise_source.standard_normal((NOISE_BLOCK, 2))
            self._cycle = 0
        noise = self._noise[self._cycle]
        self._cycle += 1
        if self.latency:
            written(self._scratch, self.latency.arrivals(currents))
            currents = (0.0,) * len(MOTORS)
        self._advance(self.numbers, np.asarray(currents, dtype=float), noise=noise)
        return self.counts

    def _advance(self, numbers, currents, steps=None, noise=None, dt=None) -> None:
        ok = run_cycle(
            numbers,
            self.state,
            self._scratch,
            currents,
            np.zeros(2) if noise is None else noise,
            self.counts,
            self.rig.steps_per_cycle if steps is None else steps,
            self.dt if dt is None else dt,
        )
        if not ok:
            raise HardwareError(
                f"emulated robot, trial '{self._trial}': the state became non-finite at "
                f"{self.state['time'][0]:.3f} s under currents {currents[0]:.2f}, "
                f"{currents[1]:.2f} A; start a new trial"
            )

    def _place(self, scene: Scene) -> None:
        """Write down the scene's object; it rests at its first place until the trial begins."""
        for name in ("cylinder", "orbit", "ball_mass"):
            self.numbers[name][0] = 0.0
        self._first = np.zeros(4)
        weights = scene.weights or Weights()
        self.numbers["hung_mass"][0] = weights.left, weights.right
        around = scene.cylinder or scene.ball or scene.peg
        if around is None:
            return
        numbers = around.x, around.y, around.diameter / 2, around.friction
        self.numbers["cylinder"][0] = numbers
        self._first[:2] = around.x, around.y
        if scene.ball is not None:
            self.numbers["ball_mass"][0] = scene.ball.mass
            self._first[2:] = scene.ball.vx, scene.ball.vy
        if scene.peg is not None:
            turn, phase = 2 * np.pi / scene.peg.period, scene.peg.phase
            self.numbers["orbit"][0] = scene.peg.radius, turn, phase
            out = scene.peg.radius * np.array([np.cos(phase), np.sin(phase)])
            self._first[:2] += out
            self._first[2:] = -turn * out[1], turn * out[0]

    def _settle(self) -> None:
        """Let the arm hang, tendons off, then take up the tendons' slack."""
        if np.any(self.numbers["gravity"][0]):
            calm = self.numbers.copy()
            calm["damping"] *= SETTLE_DAMPING
            calm["supply"] = 0.0
            calm["orbit"] = calm["ball_mass"] = calm["hung_mass"] = 0.0
            self.state["wound"] = -1.0
            self._advance(calm, np.zeros(2), steps=SETTLE_STEPS, dt=SETTLE_STEP)
        hanging = self.state["phi"][0].copy()
        creep = self.state["creep"][0].copy()
        self.state = np.zeros(1, STATE)
        self.state["phi"][0] = hanging
        self.state["creep"][0] = creep
        self.state["object"][0] = self._first
        self._advance(self.numbers, np.zeros(2), steps=0)
        self.state["wound"] = self._scratch["shortening"]

    def generator(self, purpose: str, seed: int | None = None) -> np.random.Generator:
        """A source of chance that depends on nothing but a seed, the machine's, and its purpose."""
        own = self.seed if seed is None else seed
        return np.random.default_rng([own, zlib.crc32(purpose.encode())])
