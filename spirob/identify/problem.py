"""What fitting, searching and judging need of a machine: its model against its measurement.

The coupled model of the arm is one such problem, the inverse model of any motor rig another; the
search for a missing effect knows only this.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from spirob.parameter import Table

LARGE, SMALL = 0.2, 2e-4  # below, milli and micro read better
PREFIXES = {"A", "V", "N", "N·m"}  # units that take one in everyday use


@dataclass(frozen=True)
class Effort:
    """The signal in which model and measurement are compared.

    name  what it is called in a sentence, "motor current";  unit  of the residual, SI
    """

    name: str
    unit: str

    def shown(self, *values: float) -> str:
        """Values as a reader wants them, "12.3 to 4.5 mA"; one unit for all, set by the largest."""
        largest = max((abs(v) for v in values), default=0.0)
        factor, prefix = 1.0, ""
        if self.unit in PREFIXES and 0.0 < largest < LARGE:
            factor, prefix = (1e3, "m") if largest >= SMALL else (1e6, "µ")
        # four digits where the number is large, never fewer than three
        texts = [
            f"{factor * v:.4g}" if factor * largest >= 1e3 else f"{factor * v:.3g}" for v in values
        ]
        return f"{' to '.join(texts)} {prefix}{self.unit}"


@dataclass(frozen=True)
class Stretch:
    """What was going on along one uninterrupted piece of the residual, in its order, each (N,).

    trial     name;  channel  which of several motors, "" where there is one
    seconds   time since the trial began [s]
    position, velocity   of the driven axis, in `units`
    effort    as measured
    still     speed below which the axis counts as standing, in the unit of velocity
    forward, backward    what the two directions are called
    angle        of the motor [rad];  gear  its turns for one of the output; None where not known
    turn         what one turn of the angle is: of the "motor", or the whole "stroke" of an axis
                 whose motor's turns are not known
    lag          of the axis behind its command, in the unit of what is commanded
    command_rate of that command, per second
    temperature  of the winding [°C]; all three (N,), None where not recorded
    """

    trial: str
    channel: str
    seconds: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    effort: np.ndarray
    still: float
    forward: str
    backward: str
    angle: np.ndarray | None = None
    gear: float | None = None
    turn: str = "motor"
    lag: np.ndarray | None = None
    command_rate: np.ndarray | None = None
    temperature: np.ndarray | None = None


@dataclass(frozen=True)
class Rotor:
    """A motor in one trial, unfiltered: what a ripple over its turns follows.

    angle   [rad];  effort  as measured, both (n,)
    every   the residual keeps every n-th sample;  use  of these, unless it is left out, (n,)
    """

    angle: np.ndarray
    effort: np.ndarray
    every: int
    use: np.ndarray | None = None

    @property
    def compared(self) -> np.ndarray:
        """Places of the samples that the residual keeps."""
        return compared(len(self.angle), self.every, self.use)


class Problem(Protocol):
    """Model minus measurement on a set of trials, as a function of the model's numbers.

    table    all numbers of the model, effects at their neutral ones
    edges    (trials + 1,) where each trial begins and ends in the residual
    rows     (N,) which samples are of the effort itself; others are of further signals, weighted
             to its unit: they help to decide, and do not count in a score
    block    samples over which the residual is correlated at most: the block of resampling
    effort   name and unit of the residual
    workers  threads that work on it may use
    """

    edges: np.ndarray
    rows: np.ndarray
    workers: int

    @property
    def table(self) -> Table:
        """All numbers of the model."""

    @property
    def block(self) -> int:
        """Samples of the residual in half a second."""

    @property
    def effort(self) -> Effort:
        """Name and unit of what is compared."""

    def measured(self) -> np.ndarray:
        """What was measured, in the order of the residual, (N,)."""

    def __call__(self, changes: Mapping[str, float]) -> np.ndarray:
        """Model minus measurement with some numbers changed, (N,)."""

    def many(self, points: Sequence[Mapping[str, float]]) -> list[np.ndarray]:
        """Residuals at several points."""

    def stretches(self) -> list[Stretch]:
        """What was going on along the residual; the stretches follow one another as it does."""

    def rotors(self) -> list[list[Rotor]]:
        """All motors of each trial; none where their angles are not known."""

    def raw(self) -> list[np.ndarray]:
        """The measured effort before any filter, one array for each stretch."""

    def spaced(self) -> list[int]:
        """Of each stretch, samples of the filter's clock from one of `raw` to the next."""

    def filter(self, values: np.ndarray) -> np.ndarray:
        """What the residual's filter leaves of unfiltered signals, along the last axis."""


def compared(count: int, every: int, use: np.ndarray | None) -> np.ndarray:
    """Places of every n-th of `count` samples, without those that `use` (count,) leaves out."""
    places = np.arange(0, count, every)
    return places if use is None else places[use[places]]


def rms(values: np.ndarray) -> float:
    """Root of the mean square, in the unit of the values."""
    return float(np.sqrt(np.mean(values**2)))


def effort_rms(problem: Problem) -> float:
    """RMS of the measured effort itself, in its unit."""
    return rms(problem.measured()[problem.rows])


FITTED = (
    "winch.efficiency",
    "motor.rotor_damping",
    "motor.rotor_inertia",
    "arm.base_stiffness",
    "arm.damping_time",
    "arm.bends_per_hinge",
    "tendon.stiffness",
    "winch.efficiency_difference",
    "motor.rotor_damping_difference",
    "motor.rotor_inertia_difference",
    "winch.radius_difference",
)
