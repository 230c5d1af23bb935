"""Blocks of one log of the arm: the model plays it from rest, and a part of it is compared.

The arm's state in the midst of a log is not in the log, so a late block cannot be begun where it
begins: all that comes before it is played, too, but counts for nothing.
"""

from dataclasses import replace

import numpy as np

from spirob.errors import DataError, TooShort
from spirob.identify.measurement import Measurement
from spirob.identify.residual import BLOCK
from spirob.machine.arm.roles import Part
from spirob.machine.splitting import SHORTEST


def block(trial: Measurement, part: Part) -> Measurement:
    """The trial up to the end of its part; what comes before the part is not compared.

    Raises TooShort where a log that is to be divided is shorter than 4 s, DataError where less
    than half a second of the part is compared.
    """
    cycles = len(trial.current)
    if part.whole:
        return trial
    if cycles < 1e3 * SHORTEST:
        raise TooShort(trial.name, cycles, round(1e3 * SHORTEST), "a log that is to be divided")
    begin, end = round(part.begin * cycles), round(part.end * cycles)
    part_of_it = replace(
        trial.until(end),
        name=f"{trial.name} ({100 * part.begin:.0f} to {100 * part.end:.0f} %)",
    )
    return replace(part_of_it, use=_from(part_of_it, begin))


def _from(trial: Measurement, begin: int) -> np.ndarray | None:
    if begin == 0:
        return trial.use
    cycles = len(trial.current)
    use = np.ones(cycles, bool) if trial.use is None else trial.use.copy()
    use[:begin] = False
    if 1e-3 * np.count_nonzero(use) < BLOCK:
        raise DataError(
            f"{trial.name}: of its part from {1e-3 * begin:.3g} to {1e-3 * cycles:.3g} s less "
            f"than {BLOCK:g} s are left after the row filters"
        )
    return use
