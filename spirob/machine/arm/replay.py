"""A log of the arm as a trial that the model can play again.

How the arm was commanded is not in such a log, and need not be: the motor that does the work is
made to follow the motion that was measured, the other one gets the current that was measured.  The
error is then that of the working motor's current, and of the length that the other winds in.
Following takes an error of the speed, i/K_v; so the measured current is fed forward as one, and
what the controller adds is the model's own error.
"""

from collections.abc import Mapping

import numpy as np

from spirob.control.law import CURRENT, DISPLACEMENT
from spirob.control.schedule import Schedule
from spirob.errors import DataError, MissingChannel
from spirob.identify.measurement import Measurement
from spirob.logs.readers import Table
from spirob.machine.arm.description import ArmFile
from spirob.machine.arm.rows import usable
from spirob.machine.filtering import derivative, smooth
from spirob.machine.grids import Logged, even_grids
from spirob.machine.rig import Column
from spirob.robot import MOTORS, Scene

CYCLE = 1e-3  # s, of the model
BEGIN = 0.05  # s at the beginning, in which the arm has to stand
MOVING = 0.2  # of the fast part of the motion: so fast an arm does not stand
ROOM = 2.0  # times the largest current: the model's command never reaches its limit


def arm_trial(table: Table, rig: ArmFile, role: str) -> tuple[Measurement, list[str]]:
    """A log as a trial of the model, and sentences about what was repaired.

    Raises MissingChannel and DataError in a sentence that names the file.
    """
    for column in rig.columns():
        table.column(column)
    time = rig.time.model_copy(update={"unit": table.units.get(rig.time.column, rig.time.unit)})
    name, said = table.name, list(table.said)
    values = _regular(name, table.columns, rig.model_copy(update={"time": time}), said)
    displacement = np.column_stack([values[f"{m}.position"] for m in MOTORS])
    current = np.column_stack([values[f"{m}.effort"] for m in MOTORS])
    motion, held = (
        np.column_stack([smooth(x, rig.filter.cutoff, CYCLE) for x in both.T])
        for both in (displacement, current)
    )
    velocity = np.column_stack([derivative(x, CYCLE) for x in motion.T])
    _at_rest(name, velocity)
    _currents(name, current, rig, said)
    moves = int(np.argmax(np.std(current, axis=0)))
    said.append(f"{name}: the {MOTORS[moves]} motor does the work; it follows its measured motion.")
    schedule = Schedule(
        mode=np.array([DISPLACEMENT if m == moves else CURRENT for m in range(len(MOTORS))]),
        reference=np.where(np.arange(len(MOTORS)) == moves, motion, current),
        reference_rate=velocity + held / rig.machine().gains.velocity,
        current_limit=np.full(len(MOTORS), ROOM * float(np.abs(current).max())),
    )
    use = usable(name, current, velocity, moves, rig, said)
    trial = Measurement(name, role, current, displacement, velocity, schedule, Scene(), use=use)
    return trial, said


def _regular(
    name: str, columns: Mapping[str, np.ndarray], rig: ArmFile, said: list[str]
) -> dict[str, np.ndarray]:
    """All signals in SI on the model's clock, positions in metres wound in since the beginning."""
    wanted = {
        f"{m}.{k}": getattr(c, k) for m, c in rig.motors().items() for k in ("position", "effort")
    }
    for column in (rig.time, *wanted.values()):
        if column.column not in columns:
            raise MissingChannel(name, column.column, list(columns))
    cells = {key: np.asarray(columns[c.column], float) for key, c in wanted.items()}
    scaled = {key: _scaled(c, columns) for key, c in wanted.items()}
    stamps = np.asarray(columns[rig.time.column], float)
    _, grids = even_grids(Logged(name, rig.time, stamps, wanted, cells, scaled), said)
    if len(grids) != 1:
        broken = next(text for text in reversed(said) if "cut there" in text)
        raise DataError(
            f"{broken.removesuffix('.')}, but the model plays a log from its beginning to its end; "
            "give whole ones"
        )
    even = np.arange(grids[0]["time"][0], grids[0]["time"][-1], CYCLE)
    values = {}
    for key in wanted:
        of = rig.motors()[key.partition(".")[0]]
        si = of.amperes if key.endswith("effort") else of.metres(rig.machine())
        values[key] = si * np.interp(even, grids[0]["time"], grids[0][key])
    begin = round(BEGIN / CYCLE)
    for motor in MOTORS:
        values[f"{motor}.position"] -= np.median(values[f"{motor}.position"][:begin])
    return values


def _scaled(column: Column, columns: Mapping[str, np.ndarray]) -> np.ndarray:
    return column.factor * (np.asarray(columns[column.column], float) - column.zero)


def _currents(name: str, current: np.ndarray, rig: ArmFile, said: list[str]) -> None:
    """A constant current may have been commanded, and is said; raise where both are constant."""
    stuck = [m for m in range(len(MOTORS)) if np.ptp(current[:, m]) == 0.0]
    columns = [c.effort.column for c in rig.motors().values()]
    if len(stuck) == len(MOTORS):
        both = "' and '".join(columns)
        raise DataError(f"{name}: '{both}' are constant; nothing can be told from them")
    said += [
        f"{name}: '{columns[m]}' is constant at {current[0, m]:.3g} A, taken as commanded."
        for m in stuck
    ]


def _at_rest(name: str, velocity: np.ndarray) -> None:
    """Raise where the log begins in the midst of a motion."""
    first = np.abs(velocity[: round(BEGIN / CYCLE)]).mean(axis=0)
    if np.any(first > MOVING * np.quantile(np.abs(velocity), 0.95)):
        raise DataError(
            f"{name}: it begins in motion; the model plays a log from the straight arm at rest"
        )
