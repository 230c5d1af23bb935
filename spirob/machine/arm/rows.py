"""Which cycles of an arm's log are compared: not where a drive saturates, and what `rows` keeps.

All of a log is played, as what the arm did before is in its state.  A row that is left out counts
in no signal of its trial: both motors pull at one arm, and a current that one of them lacks is
missing in what the other has to hold.
"""

import numpy as np

from spirob.identify.residual import STILL
from spirob.machine import checks
from spirob.machine.arm.description import ArmFile
from spirob.machine.rows import FULL, widened
from spirob.machine.standstill import LEAST, holds
from spirob.robot import MOTORS

CYCLE = 1e-3  # s, of the model


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
    use = np.ones(len(current), bool)
    if rig.filter.drop:
        use[: rig.filter.drop] = use[-rig.filter.drop :] = False
    # the filter smears what happens beside a row
    full = widened(_saturated(current, rig), round(0.5 / (rig.filter.cutoff * CYCLE)))
    _leave_out(name, use, full, "where a drive saturates", said)
    speed = np.abs(velocity[:, moves]) / rig.motors()[MOTORS[moves]].metres(rig.machine())
    if rig.rows.minimum_speed is not None:
        _leave_out(name, use, speed < rig.rows.minimum_speed, "as too slow", said)
    elif rig.rows.standstill == "drop":
        _without_holds(name, use, velocity[:, moves], said)
    if rig.rows.maximum_speed is not None:
        _leave_out(name, use, speed > rig.rows.maximum_speed, "as too fast", said)
    checks.enough(name, CYCLE * np.count_nonzero(use))
    return None if use.all() else use


def _saturated(current: np.ndarray, rig: ArmFile) -> np.ndarray:
    """Cycles in which one of the motors is at its limit, (T,)."""
    limits = [m.effort.limit and m.effort.limit * m.amperes for m in rig.motors().values()]
    return np.any(np.abs(current) >= [FULL * (limit or np.inf) for limit in limits], axis=1)


def _without_holds(name: str, use: np.ndarray, v: np.ndarray, said: list[str]) -> None:
    """Leave out where the working motor stands, unless it does so most of the time."""
    still = holds(v, STILL, CYCLE)
    if np.count_nonzero(use & ~still) < LEAST * np.count_nonzero(use):
        said.append(f"{name}: the working motor stands most of the time.")
    else:
        _leave_out(name, use, still, "where the working motor stands", said)


def _leave_out(name: str, use: np.ndarray, out: np.ndarray, why: str, said: list[str]) -> None:
    if out.any():
        use &= ~out
        said.append(f"{name}: {out.mean():.1%} of the rows left out, {why}.")
