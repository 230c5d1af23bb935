"""Blocks of one log of the arm: the model plays it from rest, and a part of it is compared.

The arm's state in the midst of a log is not in the log, so a late block cannot be begun where it
begins: all that comes before it is played, too, but counts for nothing.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from spirob.errors import TooShort
from spirob.identify.measurement import Measurement
from spirob.identify.problem import Stretch
from spirob.identify.residual import Residual
from spirob.machine.arm.roles import Part
from spirob.machine.splitting import SHORTEST


@dataclass
class Blocks(Residual):
    """The residual of trials each of which counts from a cycle of its own on.

    begins  trial's name -> first cycle that counts; 0 where it is absent
    """

    begins: Mapping[str, int] = field(default_factory=dict)

    def first(self, trial: Measurement) -> int:
        """The first sample of a trial, filtered and thinned, that counts."""
        return -(-self.begins.get(trial.name, 0) // self.filter.every)

    def thin(self, values: np.ndarray, trial: Measurement) -> np.ndarray:
        """A signal of the whole trial, (T,), filtered and thinned: the part of it that counts."""
        return self.filter.thin(values, trial.name)[self.first(trial) :]

    def raw(self) -> list[np.ndarray]:
        """Unfiltered current of each driven motor of each block [A]."""
        return [
            t.current[self.begins.get(t.name, 0) :, m] for t in self.trials for m in self.driven(t)
        ]

    def _signals(
        self, trial: Measurement, current: np.ndarray, displacement: np.ndarray
    ) -> np.ndarray:
        return self._late(trial, super()._signals(trial, current, displacement))

    def _rows(self, trial: Measurement) -> np.ndarray:
        return self._late(trial, super()._rows(trial))

    def _late(self, trial: Measurement, values: np.ndarray) -> np.ndarray:
        samples = len(trial.seconds[:: self.filter.every])
        return values.reshape(-1, samples)[:, self.first(trial) :].ravel()

    def _stretch(self, trial: Measurement, motor: int) -> Stretch:
        whole, late = super()._stretch(trial, motor), slice(self.first(trial), None)
        signals = ("seconds", "position", "velocity", "effort")
        return replace(whole, **{name: getattr(whole, name)[late] for name in signals})


def block(trial: Measurement, part: Part) -> tuple[Measurement, int]:
    """The trial up to the end of its part, and the cycle from which it counts.

    Raises TooShort where a log that is to be divided is shorter than 4 s.
    """
    cycles = len(trial.current)
    if part.whole:
        return trial, 0
    if cycles < 1e3 * SHORTEST:
        raise TooShort(trial.name, cycles, round(1e3 * SHORTEST), "a log that is to be divided")
    end = slice(0, round(part.end * cycles))
    schedule = replace(
        trial.schedule,
        reference=trial.schedule.reference[end],
        reference_rate=trial.schedule.reference_rate[end],
    )
    cut = replace(
        trial,
        name=f"{trial.name} ({100 * part.begin:.0f} to {100 * part.end:.0f} %)",
        current=trial.current[end],
        displacement=trial.displacement[end],
        velocity=trial.velocity[end],
        schedule=schedule,
    )
    return cut, round(part.begin * cycles)
