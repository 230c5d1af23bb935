"""What the passive experiments with the current loop on the host share: gains, rig and trials.

A set of gains is a bandwidth at which they are placed, and the share of the back-EMF that the loop
feeds forward: all of it, as (12) has it, or none.  Such a loop lets the rotor's speed into the
current, and a pushed rotor turns the drum along: the rig has the drum's inertia, by its drawing.

What (12) leaves of a push is k_e ω(t) less what the host believes of it, k_e ω(t - τ): a matter of
the robot's own τ, R and k_e, which no trial of a drive with its own loop tells.  So the robot plays
one trial without a contact first, both currents jumping against each other about what they are
held at, and models get what that log tells (`windings`):

    i(k+1) = E i(k) + b₁ u(k-d-1) + b₀ u(k-d) - k_e ω (1 - E)/R,    τ = (d + δ)T

the windings under held voltages as in `control`, driven by the voltages that were sent
and the speed that was read, of a cycle the mean of its ends.  τ, each motor's R and each motor's
k_e are those that leave the least of the measured current; L is nominal.  Currents that jump tell
τ, rotors that turn tell k_e; currents that are held tell neither.

The baseline has neither motor nor loop: its force is the commanded one, so that its current, and
the i** that a force F_cmd asks for, is the commanded current F_cmd/n whatever touches the arm.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
import scipy

from spirob.control import HostLoop, Placed, Winding, placed
from spirob.errors import DataError
from spirob.experiments import Experiment, Known, Play, Side, Sides, plan, row, trial
from spirob.experiments.passive import COUNTS_PER_AMPERE, DIRECT, DRUM, RADIUS
from spirob.plant.rig import Motor

NOISY = ("robot", "base", "named")  # sides that no two plays of a trial find alike
COMPARED = ("robot", "named")  # whose plays are as many as they have to be
LATEST = 5e-3  # s
REACH = 0.2  # of the nominal resistance and back-EMF
GRID = 11  # latencies from which one is refined, for b₀ and b₁ have a kink at each whole cycle
LEAST = 0.05  # A, span of the current that can be told from noise and counts
TURNING = 1.0  # rad/s, RMS of a rotor whose back-EMF can: 20 mV


@dataclass(frozen=True)
class Windings:
    """τ [s] and its standard deviation [s]; R [Ω] and k_e [V·s/rad] of each motor, (motors,)."""

    latency: float
    error: float
    resistance: np.ndarray
    emf_constant: np.ndarray


def windings(current: np.ndarray, voltage: np.ndarray, speed: np.ndarray, motor: Motor) -> Windings:
    """Of a trial that begins at rest; both motors hear of their voltages in one frame.

    current, voltage, speed  (T, motors) as read [A], as sent [V], of the rotor [rad/s]
    Raises DataError where a current hardly moves or a rotor hardly turns.
    """
    if np.ptp(current, axis=0).min(initial=np.inf) < LEAST:
        raise DataError(f"a latency is told by currents that change, by {LEAST:g} A at least")
    if np.sqrt(np.mean(speed**2, axis=0)).min(initial=np.inf) < TURNING:
        raise DataError(f"a back-EMF is told by rotors that turn, by {TURNING:g} rad/s at least")
    motors = current.shape[1]
    middle = (speed + np.vstack([speed[1:], speed[-1:]])) / 2

    def left(numbers: np.ndarray) -> np.ndarray:
        shares = numbers[1:].reshape(2, motors)
        apart = [
            answer(
                Winding(float(shares[0, m]) * motor.resistance, motor.inductance),
                1e-3 * float(numbers[0]),
                voltage[:, m],
                float(shares[1, m]) * motor.emf_constant * middle[:, m],
            )
            - current[:, m]
            for m in range(motors)
        ]
        return np.concatenate(apart)

    most = 1e3 * LATEST
    grid = [np.array([t, *np.ones(2 * motors)]) for t in np.linspace(0.0, most, GRID)[1:-1]]
    begin = min(grid, key=lambda one: float(np.sum(left(one) ** 2)))
    reach = REACH * np.ones(2 * motors)
    bounds = np.array([0.0, *(1 - reach)]), np.array([most, *(1 + reach)])
    found = scipy.optimize.least_squares(left, begin, bounds=bounds, diff_step=1e-3)
    spread = 2 * found.cost / (len(found.fun) - len(begin))
    error = np.sqrt(spread * np.linalg.pinv(found.jac.T @ found.jac)[0, 0])
    resistance, emf = found.x[1:].reshape(2, motors)
    return Windings(
        1e-3 * float(found.x[0]),
        1e-3 * float(error),
        resistance * motor.resistance,
        emf * motor.emf_constant,
    )


def answer(winding: Winding, seconds: float, voltage: np.ndarray, emf: np.ndarray) -> np.ndarray:
    """Current (T,) [A] of a winding at rest under voltages that act so much later."""
    whole, first, second = winding.answer(seconds)
    sent = np.pad(voltage, (whole + 1, 0))  # nothing was before
    acts = first * sent[1 : len(voltage) + 1] + second * sent[: len(voltage)]
    acts -= (1.0 - winding.decay) / winding.resistance * emf
    return np.asarray(scipy.signal.lfilter([0.0, 1.0], [1.0, -winding.decay], acts))


JUMP, STEP = 0.5, 0.2  # of the current that is held, up and down; s between two jumps
RESTS, JUMPS = 0.3, 8  # s before the first;  how many
HALF_RPM = np.pi / 60  # rad/s
BLEND = 0.002  # s of a jump: as fast as a cycle or two


@dataclass(frozen=True)
class GainSet:
    """bandwidth [Hz], share of the back-EMF that is fed forward, latency [s] as the host has it."""

    bandwidth: float
    share: float
    latency: float

    @property
    def key(self) -> str:
        """For the name of a play."""
        return f"{self.bandwidth:g}Hz_{100 * self.share:.0f}"

    @property
    def words(self) -> str:
        """For a table."""
        forward = {1.0: "(12) whole", 0.0: "without back-EMF"}
        told = forward.get(self.share, f"{self.share:.0%} of the back-EMF")
        return f"{self.bandwidth:g} Hz {told}"

    @property
    def unsure(self) -> float:
        """By how much the current may be off because speeds are told in whole rpm [counts]."""
        motor = Motor()
        volts = self.share * motor.emf_constant * HALF_RPM
        return volts / motor.resistance * COUNTS_PER_AMPERE

    def rig(self) -> dict[str, Any]:
        """The rig without gearbox, its loop on the host."""
        host = {"bandwidth": float(self.bandwidth), "latency": float(self.latency)}
        drive = {"loop": "host", "emf_compensation": float(self.share), "host": host}
        winch = {**DIRECT["winch"], "drum_inertia": float(DRUM)}
        return {**DIRECT, "winch": winch, "drive": drive}

    def known(self, told: Windings, motor: int) -> Known:
        """What a model has of a robot's loop: the host's gains at the robot's own latency."""
        proportional, integral, derivative = self._placed().gains
        gains = {"proportional": proportional, "integral": integral, "derivative": derivative}
        rig = self.rig()
        rig["drive"]["host"] = {**gains, "latency": told.latency}
        numbers = {"resistance": told.resistance, "emf_constant": told.emf_constant}
        return Known(rig, {f"motor.{name}": float(of[motor]) for name, of in numbers.items()})

    def _placed(self) -> Placed:
        motor, loop = Motor(), HostLoop(bandwidth=self.bandwidth, latency=self.latency)
        return placed(loop, motor.resistance, motor.inductance)

    def margin(self) -> dict[str, Any]:
        """Row of the factor by which the gains may grow, by the nominal winding."""
        found = self._placed()
        return row(
            f"gain margin, {self.bandwidth:g} Hz", "1", {"base": found.times}, note=found.told()
        )


@dataclass(frozen=True, kw_only=True)
class OnHost(Experiment):
    """Trials of another experiment under each set of gains: with a contact at each place, and none.

    bandwidths  at which the gains of the loop are placed [Hz]
    shares      of the back-EMF that it feeds forward;  latency  from a reading to its voltage [s]
    told        by the robot's trial `before`; no setting
    """

    named: ClassVar[str]  # what its plays are called
    bandwidths: tuple[float, ...] = (5.0, 10.0, 20.0)
    shares: tuple[float, ...] = (1.0, 0.0)
    latency: float = 0.001
    told: Windings | None = None

    if TYPE_CHECKING:  # of the experiment whose trials are played
        places: tuple[float, ...] = ()
        current: float = 0.0

        def trial_at(self, name: str, place: float | None) -> dict[str, Any]: ...

    @property
    def sets(self) -> list[GainSet]:
        """Every set of gains, share by share."""
        found = product(self.shares, self.bandwidths)
        return [GainSet(bandwidth, share, self.latency) for share, bandwidth in found]

    @property
    def slowest(self) -> GainSet:
        """The set under which a contact shows best."""
        return GainSet(self.bandwidths[0], self.shares[-1], self.latency)

    def before(self) -> Play:
        """Both currents jump against each other about what they are held at."""
        name, one = f"{self.named}_jumps", self.slowest
        known = one.known(self.told, self.motor) if self.told else Known()
        return Play(name, jumps(name, self.current), one.rig(), known)

    def informed(self, side: Side) -> Self:
        """With the robot's own latency and windings; as it is where no voltages were sent."""
        if side.current is None or side.voltage is None:
            return self
        speed = side.velocity / RADIUS
        return replace(self, told=windings(side.current, side.voltage, speed, Motor()))

    def plays(self) -> list[Play]:
        """Every trial under every set."""
        return [
            self.play(self.play_of(one, place), place, one)
            for one in self.sets
            for place in (None, *self.places)
        ]

    def play(self, name: str, place: float | None, one: GainSet) -> Play:
        """A trial under one set; models have what the robot has told."""
        known = one.known(self.told, self.motor) if self.told else Known()
        plain = self.trial_at(name, place)
        return Play(name, plain, one.rig(), known, noisy=True)

    def told_rows(self) -> list[dict[str, Any]]:
        """Rows of what the robot's trial before has told."""
        if self.told is None:
            return []
        one, motor, nominal = self.told, self.motor, Motor()
        note = f"two deviations: {2e3 * one.error:.3f}; the host's gains are for "
        late = {"robot": 1e3 * one.latency}
        of = {"resistance": one.resistance, "back-EMF constant": one.emf_constant}
        by = {"resistance": nominal.resistance, "back-EMF constant": nominal.emf_constant}
        shares = [
            row(f"{name} over the data sheet's", "1", {"robot": of[name][motor] / by[name]})
            for name in of
        ]
        note += f"{1e3 * self.latency:g}"
        return [row("latency of the loop", "ms", late, note=note), *shares]

    def at(
        self, sides: Sides, one: GainSet, place: float | None, again: int = 0
    ) -> dict[str, Side]:
        """What every side did under one set; a side without motors has its command as current."""
        return {
            s: replace(side, current=side.command, arm_current=side.command)
            if side.current is None
            else side
            for s, side in sides[self.play_of(one, place, again)].items()
        }

    def play_of(self, one: GainSet, place: float | None, again: int = 0) -> str:
        """Its name; of the first play or of one again."""
        where = "free" if place is None else f"{100 * place:.0f}"
        return "_".join([self.named, one.key, where, *[f"again{again}"] * bool(again)])


def or_none(told: Mapping[str, float]) -> dict[str, Any]:
    """With "none" for what a current that never changes has not: the baseline's NaN."""
    return {s: "none" if s == "single" and np.isnan(v) else v for s, v in told.items()}


def jumps(name: str, current: float) -> dict[str, Any]:
    """A trial in which both currents [A] jump against each other, so that the rotors turn."""
    plans = {}
    for motor, sign in (("left", 1.0), ("right", -1.0)):
        levels = [1.0, *(1.0 + sign * JUMP * (-1.0) ** k for k in range(JUMPS))]
        times = [RESTS, *(STEP for _ in range(JUMPS))]
        plateaus = [[t, current * level] for t, level in zip(times, levels, strict=True)]
        plans[motor] = plan("current", {"kind": "steps", "plateaus": plateaus, "blend": BLEND})
    return trial(name, RESTS + STEP * JUMPS, **plans)
