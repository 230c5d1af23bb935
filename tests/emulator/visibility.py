"""How much of a hidden effect the logs show: the machine with it against its twin without.

Both play the same trial with the same seed and controller, noise and counts included, and nothing
is fitted.  `python -m tests.emulator.visibility` measures the table of docs/emulator.md.
"""

import functools
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from scipy.signal import butter, sosfiltfilt

from spirob.bench import Trial, play
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
from spirob.control.law import Gains
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.emulator.hidden import effects
from spirob.emulator.machine import Machine
from spirob.logs.transmission import Transmission

EXPERIMENT = Path(__file__).parents[2] / "conf/experiment/excitation.yaml"
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

    def exchange(self, command: bytes) -> list[CanFrame]:
        """One cycle: the command and what both drives answer."""
        counts = self.machine.cycle(decode_command(command, 2)).tolist()
        answers = [encode_feedback(Feedback(*said)) for said in counts]
        frames = [CanFrame(0, FEEDBACK_ID + n, data) for n, data in enumerate(answers, start=1)]
        return [CanFrame(0, COMMAND_ID, command), *frames]


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


def record(trial: Trial, effect: str, strength: float = 1.0, seed: int = 1) -> Recorded:
    """Play a trial on a machine with an effect, without the bus."""
    machine = Machine(EmulatedRig(), HiddenSettings(effect, strength), seed)
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
    play(trial, robot, memory, transmission=Transmission(), gains=Gains())  # type: ignore[arg-type]
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


@functools.cache
def twin(name: str, seed: int) -> Recorded:
    """The machine without any hidden effect in one of these trials."""
    (trial,) = trials([name])
    return record(trial, "none", seed=seed)


def driven(trial: Trial) -> int:
    """The motor that follows a displacement."""
    return [trial.motors[m].mode for m in ("left", "right")].index("displacement")


def row(effect: str, shown: Sequence[Trial], seeds: Sequence[int]) -> list[float]:
    """Mean share of the driven and of the other current, length of the other tendon [mm],
    current above 30 Hz [mA] and ratio of fastest rates; least and most share, largest ratio."""
    rows = []
    for trial in shown:
        m = driven(trial)
        for seed in seeds:
            one, plain = record(trial, effect, seed=seed), twin(trial.name, seed)
            share, length = in_current(one, plain), 1e3 * in_displacement(one, plain)
            rough = [1e3 * rms((r.current - smooth(r.current))[:, m]) for r in (one, plain)]
            rate = one.fastest.max() / plain.fastest.max()
            rows.append([share[m], share[1 - m], length[1 - m], rough[0] - rough[1], rate])
    table = np.array(rows)
    return [*table.mean(axis=0), table[:, 0].min(), table[:, 0].max(), table[:, 4].max()]


def main() -> None:
    """Print the table; kinds (or kind:strength, or pairs) may be named on the command line."""
    kinds = sys.argv[1:] or [name for name in effects() if name != "none"]
    shown = trials(["train_fast_left", "train_deep_right"])
    print("kind | driven current % (least-most) | other % | length mm | rough mA | rate (most)")
    for kind in kinds:
        r = row(kind, shown, (1, 2, 3))
        print(
            f"{kind} | {100 * r[0]:.1f} ({100 * r[5]:.1f}-{100 * r[6]:.1f}) | {100 * r[1]:.1f} | "
            f"{r[2]:.2f} | {r[3]:.1f} | {r[4]:.2f} ({r[7]:.2f})",
            flush=True,
        )


if __name__ == "__main__":
    main()
