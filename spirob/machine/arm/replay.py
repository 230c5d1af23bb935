"""A log of the arm as a trial that the model can play again.

How the arm was commanded is not in such a log, and need not be: the motor that does the work gets
the current that was measured and what holds the model to the motion that was measured, the other
one the measured current alone.  What is added is the model's own error, in ampere (`following`);
beside it the length that the other motor winds in is compared.  Of a motor whose command is in the
log, that is given.
"""

from collections.abc import Mapping

import numpy as np

from spirob.control.law import CURRENT, DISPLACEMENT
from spirob.control.schedule import Schedule
from spirob.errors import DataError, MissingChannel
from spirob.identify.measurement import Measurement
from spirob.logs.readers import Table
from spirob.machine.arm.beginning import BEGUN, at_rest, first_angles, held, within_stroke
from spirob.machine.arm.description import ArmFile
from spirob.machine.arm.rows import usable
from spirob.machine.filtering import derivative, smooth
from spirob.machine.grids import Logged, even_grids
from spirob.machine.rig import Column
from spirob.robot import MOTORS, Scene

CYCLE = 1e-3  # s, of the model
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
    length, current = (_both(values, kind) for kind in ("position", "effort"))
    motion = np.column_stack([smooth(x, rig.filter.cutoff, CYCLE) for x in length.T])
    velocity = np.column_stack([derivative(x, CYCLE) for x in motion.T])
    begin = slice(0, BEGUN)
    zero = np.median(length[begin], axis=0)
    at_rest(name, velocity[begin], velocity)
    _currents(name, current, rig, said)
    within_stroke(name, length - zero, current, rig)
    moves = int(np.argmax(np.std(current, axis=0)))
    said.append(f"{name}: the {MOTORS[moves]} motor does the work; it follows its measured motion.")
    given = _given(values, rig)
    schedule = Schedule(
        mode=np.array([DISPLACEMENT if m == moves else CURRENT for m in range(len(MOTORS))]),
        reference=np.where(np.arange(len(MOTORS)) == moves, motion - zero, given),
        reference_rate=velocity + given / rig.machine().gains.velocity,
        current_limit=np.full(len(MOTORS), ROOM * float(np.abs(current).max())),
        held=held(current[begin]),
    )
    trial = Measurement(
        name,
        role,
        current,
        length - zero,
        velocity,
        schedule,
        Scene(),
        first_angle=first_angles(zero, rig),
        use=usable(name, current, velocity, moves, rig, said),
    )
    return trial, said


def _both(values: Mapping[str, np.ndarray], kind: str) -> np.ndarray:
    return np.column_stack([values[f"{motor}.{kind}"] for motor in MOTORS])


def _given(values: Mapping[str, np.ndarray], rig: ArmFile) -> np.ndarray:
    """What each motor is given from cycle to cycle [A], (T, 2).

    A drive reports the current of the cycle that ends; a command is for the one that begins.
    """
    found = []
    for motor, columns in rig.motors().items():
        reported = values[f"{motor}.effort"]
        coming = np.append(reported[1:], reported[-1])
        found.append(coming if columns.command is None else values[f"{motor}.command"])
    return np.column_stack(found)


def _regular(
    name: str, columns: Mapping[str, np.ndarray], rig: ArmFile, said: list[str]
) -> dict[str, np.ndarray]:
    """All signals in SI on the model's clock, positions in metres wound in."""
    wanted = {
        f"{m}.{k}": column
        for m, of in rig.motors().items()
        for k in ("position", "effort", "command")
        if (column := getattr(of, k)) is not None
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
        si = of.metres(rig.machine()) if key.endswith("position") else of.amperes(wanted[key])
        values[key] = si * np.interp(even, grids[0]["time"], grids[0][key])
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
