"""How much of a hidden effect the logs show: the machine with it against its twin without.

Both play the same trial with the same seed and controller, noise and counts included.  What the
wrong parameters could explain is judged by the twin's own sensitivity to them, to first order.
`python -m tests.emulator.visibility` measures the table of docs/lab/emulator.md.
"""

import functools
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from scipy.signal import butter, sosfiltfilt

from spirob.can_protocol import (
    AMPERE_PER_COUNT,
    COMMAND_ID,
    FEEDBACK_ID,
    CanFrame,
    Feedback,
    decode_command,
    decode_feedback,
    encode_feedback,
)
from spirob.control import Gains
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.emulator.hidden import effects
from spirob.emulator.machine import Machine
from spirob.logs.cycles import Transmission
from spirob.robot import CYCLE_NS
from spirob.trials import Trial, guard, play

EXPERIMENT = Path(__file__).parents[2] / "conf/recordings/excitation.yaml"
SHOWN = ("train_fast_left", "train_deep_right")
SEEDS = (1, 2, 3)
STEP = 0.03
PARAMETERS = (  # what a fit without the effect would adjust
    ("efficiency",),
    ("rotor_inertia",),
    ("rotor_damping",),
    ("stiffness", "damping"),
    ("damping",),
    ("first_moment", "inertia"),
)
LOW_PASS = butter(4, 30.0, fs=1000.0, output="sos")


@dataclass(frozen=True)
class Recorded:
    """What a trial's log would tell, and the fastest unit, which it would not.

    current [A], displacement [m], velocity [m/s], command [A]: (T, 2), left and right
    fastest  (T,) largest rate of any unit [rad/s]
    """

    current: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    command: np.ndarray
    fastest: np.ndarray


class Wired:
    """The drives without the bus between, which takes as long as the physics."""

    def __init__(self, machine: Machine):
        self.machine = machine
        self.now = 0  # ns

    def exchange(self, command: bytes) -> list[CanFrame]:
        """One cycle: the command and what both drives answer."""
        counts = self.machine.cycle(decode_command(command, 2)).tolist()
        answers = [encode_feedback(Feedback(*said)) for said in counts]
        sent, self.now = self.now, self.now + CYCLE_NS
        frames = [
            CanFrame(self.now, FEEDBACK_ID + n, data) for n, data in enumerate(answers, start=1)
        ]
        return [CanFrame(sent, COMMAND_ID, command), *frames]


class Memory:
    """Stands where a log would; keeps one row a cycle."""

    def __init__(self, machine: Machine):
        self.rows: list[list[float]] = []
        self._machine = machine
        self._now = self._before = [0.0, 0.0]

    def frames(self, frames: Sequence[CanFrame]) -> None:
        """Keep the currents for the row of the next cycle, as the log's reader does."""
        self._before = self._now
        self._now = [decode_feedback(f.data).current * AMPERE_PER_COUNT for f in frames[1:]]

    def cycle(self, stamp, positions, velocities, efforts, currents, *_) -> None:
        """One row: what was known when the command went out, and the command."""
        fastest = np.abs(self._machine.state["rate"]).max()
        self.rows.append([*self._before, *positions, *velocities, *currents, fastest])


def record(
    trial: Trial, effect: str, strength: float = 1.0, seed: int = 1, larger: Sequence[str] = ()
) -> Recorded:
    """Play a trial without the bus, with some of the machine's numbers larger by `STEP`."""
    machine = Machine(EmulatedRig(), HiddenSettings(effect, strength), seed)
    for field in larger:
        machine.numbers[field] *= 1 + STEP
    machine.start(trial.scene, trial.name)
    return _recorded(trial, Wired(machine))


def record_over_bus(trial: Trial, effect: str, strength: float = 1.0, seed: int = 1) -> Recorded:
    """The same over the bus, twice as slow."""
    robot = EmulatedRobot(EmulatedRig(), HiddenSettings(effect, strength), seed)
    try:
        robot.prepare(trial.scene, trial.name)
        return _recorded(trial, robot)
    finally:
        robot.close()


def _recorded(trial: Trial, robot) -> Recorded:
    memory = Memory(robot.machine)
    guarded = guard(robot, Transmission())
    guarded.arm()
    play(trial, guarded, memory, gains=Gains())  # type: ignore[arg-type]
    columns = np.array(memory.rows)
    return Recorded(*(columns[:, i : i + 2] for i in range(0, 8, 2)), columns[:, 8])


def rms(values: np.ndarray) -> float:
    """Root of the mean square, the mean included."""
    return float(np.sqrt(np.mean(values**2)))


def smooth(values: np.ndarray) -> np.ndarray:
    """Below 30 Hz, without delay."""
    return sosfiltfilt(LOW_PASS, values, axis=0)


def in_current(one: Recorded, other: Recorded) -> np.ndarray:
    """RMS difference of each motor's current over the RMS of its current in `other`, (2,)."""
    pairs = zip(smooth(one.current).T, smooth(other.current).T, strict=True)
    return np.array([rms(a - b) / rms(b) for a, b in pairs])


def in_displacement(one: Recorded, other: Recorded) -> np.ndarray:
    """RMS difference of each tendon's displacement [m], (2,)."""
    pairs = zip(smooth(one.displacement).T, smooth(other.displacement).T, strict=True)
    return np.array([rms(a - b) for a, b in pairs])


def trials(names: Sequence[str]) -> list[Trial]:
    """Trials of the shipped experiment."""
    plain = yaml.safe_load(EXPERIMENT.read_text(encoding="utf-8"))["trials"]
    return [Trial.from_plain(one) for one in plain if one["name"] in names]


def driven(trial: Trial) -> int:
    """The motor that follows a displacement."""
    return [trial.motors[m].mode for m in ("left", "right")].index("displacement")


@functools.cache
def twin(name: str, seed: int, larger: Sequence[str] = ()) -> Recorded:
    """The machine without any hidden effect in one of these trials."""
    (trial,) = trials([name])
    return record(trial, "none", seed=seed, larger=larger)


def unexplained(differences: Sequence[np.ndarray], seed: int) -> float:
    """Share of the driven currents that no change of `PARAMETERS` makes up for, all trials."""
    shown = trials(SHOWN)
    plain = [smooth(twin(trial.name, seed).current)[:, driven(trial)] for trial in shown]
    columns = [
        np.concatenate(
            [
                smooth(twin(trial.name, seed, larger).current)[:, driven(trial)] - before
                for trial, before in zip(shown, plain, strict=True)
            ]
        )
        for larger in PARAMETERS
    ]
    sensitivity, wanted = np.column_stack(columns), np.concatenate(differences)
    fitted, *_ = np.linalg.lstsq(sensitivity, wanted, rcond=None)
    return rms(wanted - sensitivity @ fitted) / rms(np.concatenate(plain))


@dataclass(frozen=True)
class Row:
    """One line of the table, over `SHOWN` and `SEEDS`.

    share     of the driven current, one for each trial and seed [-]
    left      of it after the parameters are fitted, one for each seed [-]
    other     share of the other motor's current, mean [-]
    length    difference of the other tendon's displacement, mean RMS [m]
    rough     driven current above 30 Hz, mean increase of its RMS [A]
    rate      fastest unit over that of the twin, largest [-]
    """

    share: list[float]
    left: list[float]
    other: float
    length: float
    rough: float
    rate: float


def row(effect: str) -> Row:
    """Measure one line of the table."""
    share, left, rest = [], [], []
    for seed in SEEDS:
        differences = []
        for trial in trials(SHOWN):
            m = driven(trial)
            one, plain = record(trial, effect, seed=seed), twin(trial.name, seed)
            shares = in_current(one, plain)
            share.append(shares[m])
            differences.append((smooth(one.current) - smooth(plain.current))[:, m])
            rough = [rms((r.current - smooth(r.current))[:, m]) for r in (one, plain)]
            rate = one.fastest.max() / plain.fastest.max()
            length = in_displacement(one, plain)[1 - m]
            rest.append([shares[1 - m], length, rough[0] - rough[1], rate])
        left.append(unexplained(differences, seed))
    table = np.array(rest)
    other, length, rough = table[:, :3].mean(axis=0)
    return Row(share, left, other, length, rough, table[:, 3].max())


def main() -> None:
    """Print the table; kinds (or kind:strength, or pairs) may be named on the command line."""
    kinds = sys.argv[1:] or [name for name in effects() if name != "none"]
    print("| kind | current % | after a fit % | other current % | length mm | rough mA | rate |")
    for kind in kinds:
        r = row(kind)
        share, left = 100 * np.array(r.share), 100 * np.array(r.left)
        print(
            f"| {kind} | {share.mean():.1f} ({share.min():.1f}-{share.max():.1f}) | "
            f"{left.mean():.1f} ({left.min():.1f}-{left.max():.1f}) | {100 * r.other:.1f} | "
            f"{1e3 * r.length:.2f} | {1e3 * r.rough:.1f} | {r.rate:.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
