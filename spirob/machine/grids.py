"""From the columns of a log to even grids: its clock, its positions, and what breaks it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spirob.machine import checks
from spirob.machine.clock import Clock, clock_of
from spirob.machine.columns import ANGLES, TICK, TIME_UNITS, Column, PositionColumn
from spirob.machine.pieces import breaks, grids_of
from spirob.machine.positions import Repaired, repaired
from spirob.machine.unwrapping import Track

BITS = (8, 10, 12, 13, 14, 16, 17, 18, 20, 24, 32)  # of an encoder's turn
TURNS = (1.0, 2.0)  # after which a position begins again
ASIDE = ("velocity", "reference")  # without them a row is still worth it
SOME = 0.4  # of the rows of these hold a number, or they are left out


@dataclass(frozen=True)
class Logged:
    """A log's columns that are used.

    time     its column;  stamps  in it as they were logged, (N,)
    columns  by what they are: position, velocity, effort, reference, `joint ...`; those of an arm
             are `left.position` and so on
    cells    of each as they were logged, (N,);  values  of each in its unit, (N,)
    """

    where: str
    time: Column
    stamps: np.ndarray
    columns: Mapping[str, Column]
    cells: Mapping[str, np.ndarray]
    values: Mapping[str, np.ndarray]


def even_grids(log: Logged, said: list[str]) -> tuple[float, list[dict[str, np.ndarray]]]:
    """The sample period [s], and all columns in their units on an even grid for each piece.

    Raises DataError where the log cannot be used, NothingLeft where nothing is left of it.
    """
    unit = log.time.factor * TIME_UNITS[log.time.unit]
    smooth = {key: values for key, values in log.values.items() if key != "reference"}
    clock = clock_of(log.where, np.sign(unit) * log.stamps, abs(unit), smooth, said)
    values = {key: v[clock.rows].astype(float) for key, v in log.values.items()}
    for key in [key for key in values if key == "effort" or key.endswith("position")]:
        checks.moving(log.where, log.columns[key].column, values[key])
    broken = np.zeros(len(clock.rows) - 1, bool)
    for key in [key for key in values if key.endswith("position") or key.startswith("joint ")]:
        found, known = _moved(log, key, values, clock, said)
        values[key][known] = found.values
        broken[known[found.jumps] - 1] = True
        if key == "position" and found.modulus and "reference" in values:
            lag = values["reference"] - values[key]
            values["reference"] -= found.modulus * np.rint(lag / found.modulus)
    aside = ASIDE if "position" in values else ()
    period = clock.period
    for key in [key for key in values if key not in aside]:
        silent, own = breaks(log.where, log.columns[key].column, clock, values[key], said)
        broken |= silent
        period = max(period, own)
    for key in [key for key in values if key in aside]:
        if np.isfinite(values[key]).mean() < SOME:
            said.append(f"{log.where}: '{log.columns[key].column}' is mostly empty and left out.")
            del values[key]
    return period, grids_of(log.where, clock, values, broken, period, said)


def _moved(
    log: Logged, key: str, values: Mapping[str, np.ndarray], clock: Clock, said: list[str]
) -> tuple[Repaired, np.ndarray]:
    """A position as the axis moved, and the rows, among those of the clock, that tell it."""
    column, known = log.columns[key], np.flatnonzero(np.isfinite(values[key]))
    if column.unit != TICK:
        checks.not_counts(log.where, column.column, log.values[key], log.cells[key])
    size = abs(column.factor)
    turn = 2 * np.pi / ANGLES[column.unit] if column.unit in ANGLES else None
    modulus = column.modulus if isinstance(column, PositionColumn) else None
    speed = values.get("velocity") if key == "position" else None
    track = Track(
        values[key][known],
        clock.seconds[known],
        clock.period,
        clock.longest,
        [*(turn * k for k in TURNS if turn), *(size * 2.0**bits for bits in BITS)],
        modulus,
        None if speed is None else speed[known],
    )
    return repaired(log.where, column.column, track, said), known
