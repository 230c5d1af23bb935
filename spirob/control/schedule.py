"""What a trial asks of each motor, cycle by cycle."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Schedule:
    """Feedback mode and reference of every motor at every cycle.

    mode           (M,) int, constants of `control.law`; fixed during a trial
    reference      (T, M) in the unit of the mode: A, m/s, m or N
    reference_rate (T, M) [m/s], read by the displacement mode only
    current_limit  (M,) the command stays within ± this [A]
    held           (M,) currents under which the arm has come to rest before [A]; None: none
    """

    mode: np.ndarray
    reference: np.ndarray
    reference_rate: np.ndarray
    current_limit: np.ndarray
    held: np.ndarray | None = None

    @property
    def cycles(self) -> int:
        """Length of the trial in cycles."""
        return len(self.reference)
