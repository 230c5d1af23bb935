"""One side of one trial as signals: what a robot logged, a model answered, or the baseline did."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from spirob.plant.single import Motion
from spirob.robot import CYCLE_NS, MOTORS
from spirob.trace import Trace, moving_average

WINDOW = 100  # samples, the paper's filter


@dataclass(frozen=True)
class Side:
    """Signals of both motors, columns left and right, one row a cycle of 1 ms.

    current       (T, 2) as the drive reports it [A]; None where there is no motor
    displacement  (T, 2) wound-in length [m];  velocity (T, 2) [m/s]
    command       (T, 2) commanded current [A]
    arm_current   (T, 2) i** of a model whose loop is on the host [A]; None of all others
    voltage       (T, 2) that the host sent [V]; None where the drive closes the current loop
    """

    current: np.ndarray | None
    displacement: np.ndarray
    velocity: np.ndarray
    command: np.ndarray
    arm_current: np.ndarray | None = None
    voltage: np.ndarray | None = None

    @classmethod
    def from_trace(cls, trace: Trace) -> "Side":
        """From a log or a simulated trial; raises MissingChannel, and DataError on a NaN."""
        names = ["current", "displacement", "velocity", "command"]
        more = ("arm_current", "voltage")
        names += [name for name in more if f"{MOTORS[0]}.{name}" in trace.signals]
        trace.require_finite([f"{motor}.{name}" for motor in MOTORS for name in names])
        return cls(
            **{n: np.column_stack([trace[f"{motor}.{n}"] for motor in MOTORS]) for n in names}
        )

    @classmethod
    def from_motion(cls, motion: Motion, command: np.ndarray) -> "Side":
        """From the baseline, which has tendons and no motors; command [A] is what it was asked."""
        return cls(None, motion.shortening, motion.shortening_rate, command)

    @classmethod
    def mean(cls, sides: Sequence["Side"]) -> "Side":
        """Of one trial played several times; a signal that one of them lacks is left out."""
        of = {f.name: [getattr(side, f.name) for side in sides] for f in fields(cls)}
        whole = {n: v for n, v in of.items() if all(one is not None for one in v)}
        return cls(**{"current": None, **{n: np.mean(v, axis=0) for n, v in whole.items()}})

    @property
    def seconds(self) -> np.ndarray:
        """Time since the start [s]."""
        return np.arange(len(self.displacement)) * (CYCLE_NS / 1e9)

    def driven(self, signal: str, motor: int) -> np.ndarray:
        """One motor's signal; "filtered" is the current after the paper's 100-sample mean."""
        name = "current" if signal == "filtered" else signal
        values = getattr(self, name)
        if values is None:
            raise ValueError(f"this side has no {signal}")
        one = np.asarray(values[:, motor], dtype=float)
        return moving_average(one, WINDOW, signal) if signal == "filtered" else one
