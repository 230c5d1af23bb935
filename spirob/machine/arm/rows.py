"""Which cycles of an arm's log are compared, and which its numbers determine.

All of a log is played, as what the arm did before is in its state.  A row that is left out counts
in no signal of its trial: both motors pull at one arm, and a current that one of them lacks is
missing in what the other has to hold.
"""

from collections.abc import Iterator

import numpy as np

from spirob.identify.residual import STILL
from spirob.machine import checks
from spirob.machine.arm.description import ArmFile
from spirob.machine.checks import FULL, widened
from spirob.machine.motion import LEAST, holds
from spirob.robot import MOTORS

CYCLE = 1e-3  # s, of the model
STANDS = "where the working motor stands"


def usable(
    name: str,
    current: np.ndarray,
    velocity: np.ndarray,
    moves: int,
    rig: ArmFile,
    said: list[str],
) -> np.ndarray | None:
    """Cycles that are compared, (T,); None where none is left out.

    current   unfiltered [A], (T, 2);  velocity  filtered [m/s], (T, 2)
    moves     the motor that does the work, whose speed counts
    said      gets a sentence for each reason

    Raises DataError where less than a second is left.
    """
    use, lost = np.ones(len(current), bool), []
    if rig.filter.drop:
        use[: rig.filter.drop] = use[-rig.filter.drop :] = False
    for out, why in _left_out(current, velocity[:, moves], MOTORS[moves], rig):
        if why == STANDS and np.count_nonzero(use & ~out) < LEAST * np.count_nonzero(use):
            said.append(f"{name}: the working motor stands most of the time.")
        elif out.any():
            use &= ~out
            lost.append(f"{out.mean():.1%} of the rows left out, {why}")
    checks.enough(name, CYCLE * np.count_nonzero(use), "; ".join(lost))
    said += [f"{name}: {text}." for text in lost]
    return None if use.all() else use


def _left_out(
    current: np.ndarray, v: np.ndarray, working: str, rig: ArmFile
) -> Iterator[tuple[np.ndarray, str]]:
    """Cycles that do not count, (T,), and why; v is the speed of the working motor [m/s]."""
    reach = round(0.5 / (rig.filter.cutoff * CYCLE))  # the filter smears what is beside a row
    for m, (motor, columns) in enumerate(rig.motors().items()):
        if columns.effort.limit is not None:
            limit = columns.effort.limit * columns.amperes(columns.effort)
            full = np.abs(current[:, m]) >= FULL * limit
            yield widened(full, reach), f"where the drive of the {motor} motor saturates"
    speed = np.abs(v) / rig.motors()[working].metres(rig.machine())
    if rig.rows.minimum_speed is not None:
        yield speed < rig.rows.minimum_speed, "as too slow"
    elif rig.rows.standstill == "drop":
        yield holds(v, STILL, CYCLE), STANDS
    if rig.rows.maximum_speed is not None:
        yield speed > rig.rows.maximum_speed, "as too fast"
