"""From the columns of a log to even grids, one for each piece between what breaks it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import scipy
from scipy.ndimage import percentile_filter

from spirob.errors import DataError, NothingLeft
from spirob.machine.description.columns import ANGLES, TICK, TIME_UNITS, Column, PositionColumn
from spirob.machine.recordings import checks
from spirob.machine.recordings.clock import SHORTEST, Clock, bridged, clock_of, of_a_register
from spirob.machine.recordings.positions import Repaired, repaired
from spirob.machine.recordings.unwrapping import Track

PIECE = 0.5  # s, of a piece at least
FEWEST = 12  # samples of one
SINGLE = 2.5  # usual steps over which a curve through the rows beside is as good as a row
AROUND, USUAL = 11, 75  # steps around one, and the percentile of them that is usual there
MOST = 0.5  # of a log has to be left
SLOWER = 1.5  # times the period of the log: a column of its own period
FILLED = "filled"  # rows of a grid where there was no row of the log, or a broken one, 0 or 1


def breaks(
    where: str, name: str, clock: Clock, values: np.ndarray, said: list[str]
) -> tuple[np.ndarray, float]:
    """Between which rows a column says nothing, (n - 1,), and its own sample period [s].

    values  (n,), NaN where there is none

    Raises DataError where it holds hardly a number.
    """
    known = np.flatnonzero(np.isfinite(values))
    count, missing = len(values), len(values) - len(known)
    broken = np.zeros(count - 1, bool)
    if not missing:
        return broken, clock.period
    if len(known) < FEWEST:
        raise DataError(f"{where}: column '{name}' has no number in {missing} of {count} rows")
    apart = np.diff(clock.seconds[known])
    own = float(np.median(apart))
    holes = (apart > max(clock.longest, bridged(own))) & (np.diff(known) > 1)
    for begin, end in zip(known[:-1][holes], known[1:][holes], strict=True):
        broken[begin:end] = True
    broken[: known[0]] = broken[known[-1] :] = True
    if own > SLOWER * clock.period:
        said.append(f"{where}: '{name}' has a number in {len(known)} of {count} rows only.")
        return broken, own
    lost = int(np.count_nonzero(~np.isfinite(values[1:]) & broken))
    if missing > lost:
        said.append(f"{where}: {missing - lost} missing values of '{name}' were bridged.")
    if lost:
        said.append(
            f"{where}: '{name}' has no number in {lost} rows in a run; the log was cut there."
        )
    return broken, clock.period


def grids_of(
    where: str,
    clock: Clock,
    columns: Mapping[str, np.ndarray],
    broken: np.ndarray,
    period: float,
    said: list[str],
) -> list[dict[str, np.ndarray]]:
    """The columns, (n,) each, on an even grid for each piece, with `time` [s] and `filled`.

    broken  (n - 1,) between which rows the log breaks besides its gaps
    period  of the grid [s], that of the slowest column

    Pieces shorter than half a second are dropped.  Raises DataError where less than half of the
    log is left, NothingLeft where less than a trial needs.
    """
    steps = np.diff(clock.seconds)
    begins = np.zeros(len(steps), bool)
    begins[clock.begins - 1] = True
    gaps = (steps > clock.longest) & ~begins
    cuts = np.flatnonzero(gaps | begins | broken) + 1
    grids, left, scraps = [], 0.0, 0.0
    for rows in np.split(np.arange(len(clock.seconds)), cuts):
        length = float(np.ptp(clock.seconds[rows]))
        if length < PIECE or len(rows) < FEWEST:
            scraps += length
            continue
        left += length
        inside = {name: values[rows] for name, values in columns.items()}
        grids.append(_grid(clock.seconds[rows], inside, period))
    if gaps.any():
        count = int(gaps.sum())
        said.append(
            f"{where}: {count} gap{'s' * (count > 1)}, the longest {steps[gaps].max():.3g} s; "
            "the log was cut there."
        )
    if len(grids) > 1 or scraps:
        dropped = f", and {scraps:.2g} s of scraps dropped" if scraps else ""
        said.append(f"{where}: used in {len(grids)} pieces, {left:.3g} s{dropped}.")
    whole = steps[~gaps & ~begins & ~broken] / clock.period
    if (lost := round(float(whole.sum())) - len(whole)) > 0:
        said.append(f"{where}: {lost} lost samples were bridged.")
    if left < SHORTEST:
        raise NothingLeft(f"{where}: gaps leave less than {SHORTEST:g} s of it")
    if left < MOST * (left + scraps):
        raise DataError(
            f"{where}: it is broken {len(cuts)} times, and {left:.3g} of {left + scraps:.3g} s are "
            "left in pieces of half a second and more"
        )
    return grids


def _grid(
    seconds: np.ndarray, columns: Mapping[str, np.ndarray], period: float
) -> dict[str, np.ndarray]:
    even = np.arange(seconds[0], seconds[-1] + 0.5 * period, period)
    filled = np.zeros(len(even))
    grid = {}
    for name, values in columns.items():
        good = np.isfinite(values)
        known, told = seconds[good], values[good]
        grid[name] = _along(even, known, told, period)
        after = np.clip(np.searchsorted(known, even), 1, len(known) - 1)
        steps = np.diff(known)
        usual = np.maximum(period, percentile_filter(steps, USUAL, AROUND, mode="nearest"))
        filled[(steps > SINGLE * usual)[after - 1]] = 1.0
    return {**grid, FILLED: filled, "time": even}


def _along(even: np.ndarray, seconds: np.ndarray, values: np.ndarray, period: float) -> np.ndarray:
    """Values at even times, by a smooth curve through the rows, held beyond the last of them."""
    if len(even) == len(seconds) and np.abs(even - seconds).max() < 1e-3 * period:
        return values
    at = np.clip(even, seconds[0], seconds[-1])
    return np.asarray(scipy.interpolate.Akima1DInterpolator(seconds, values, method="makima")(at))


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
    moduli   of positions that wrap, in their units; told by `even_grids`
    commanded  whether the effort is what was asked for
    """

    where: str
    time: Column
    stamps: np.ndarray
    columns: Mapping[str, Column]
    cells: Mapping[str, np.ndarray]
    values: Mapping[str, np.ndarray]
    moduli: dict[str, float] = field(default_factory=dict)
    commanded: bool = False


def even_grids(log: Logged, said: list[str]) -> tuple[float, list[dict[str, np.ndarray]]]:
    """The sample period [s], and all columns in their units on an even grid for each piece.

    Raises DataError where the log cannot be used, NothingLeft where nothing is left of it.
    """
    unit = log.time.factor * TIME_UNITS[log.time.unit]
    smooth = {key: values for key, values in log.values.items() if key != "reference"}
    clock = clock_of(log.where, np.sign(unit) * log.stamps, abs(unit), smooth, said)
    values = {key: v[clock.rows].astype(float) for key, v in log.values.items()}
    for key in list(values):
        name = log.columns[key].column
        values[key] = checks.without_sentinels(
            log.where, name, values[key], log.cells[key][clock.rows], said
        )
        if not key.endswith("position") and "joint " not in key:
            values[key] = checks.without_outliers(log.where, name, values[key], clock.period, said)
    for key in [key for key in values if key == "effort" or key.endswith("position")]:
        stepped = key == "effort" and log.commanded and np.any(values[key])
        if not stepped:  # a command may be one step, at which its log begins
            checks.not_constant(log.where, log.columns[key].column, values[key])
    broken = np.zeros(len(clock.rows) - 1, bool)
    for key in [key for key in values if key.endswith("position") or key.startswith("joint ")]:
        values[key] = _once(log.where, log.columns[key].column, values[key], said)
        found, known = _moved(log, key, values, clock, said)
        checks.not_constant(log.where, log.columns[key].column, found.values)  # without its spikes
        if key == "position" and "reference" in values:
            values["reference"] = _followed(log, values, found, known, clock, said)
        if found.modulus:
            log.moduli[key] = found.modulus
        values[key][known] = found.values
        broken[known[found.jumps] - 1] = True
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


def _once(where: str, name: str, values: np.ndarray, said: list[str]) -> np.ndarray:
    """A position (n,) by the row in which each frame of a slower register came, NaN elsewhere."""
    repeats = of_a_register(values)
    if repeats.any():
        said.append(
            f"{where}: '{name}' is of a register slower than the log; what it holds of it in "
            f"{int(repeats.sum())} rows was left out."
        )
    return np.where(repeats, np.nan, values)


def _followed(
    log: Logged,
    values: Mapping[str, np.ndarray],
    found: Repaired,
    known: np.ndarray,
    clock: Clock,
    said: list[str],
) -> np.ndarray:
    """The reference of a repaired position, (n,), NaN where it is broken.

    A controller sees both as they are logged: where the position is moved, the reference moves by
    as much.  A broken value may be no larger than the reference; what is left to follow is small.
    """
    rows = np.arange(len(clock.rows))
    before = np.clip(np.searchsorted(known, rows, side="right") - 1, 0, len(known) - 1)
    asked = values["reference"] + (found.values - values["position"][known])[before]
    wrong = asked - np.interp(rows, known, found.values)
    if found.modulus:
        whole = found.modulus * np.rint(wrong / found.modulus)
        asked, wrong = asked - whole, wrong - whole
    name = log.columns["reference"].column
    left = checks.without_outliers(log.where, name, wrong, clock.period, said)
    return np.where(np.isnan(left), np.nan, asked)


def _moved(
    log: Logged, key: str, values: Mapping[str, np.ndarray], clock: Clock, said: list[str]
) -> tuple[Repaired, np.ndarray]:
    """A position as the axis moved, and the rows, among those of the clock, that tell it."""
    column, known = log.columns[key], np.flatnonzero(np.isfinite(values[key]))
    if column.unit != TICK and "factor" not in column.model_fields_set:
        checks.not_counts(log.where, column.column, log.cells[key])
    size = abs(column.factor)
    turn = 2 * np.pi / ANGLES[column.unit] if column.unit in ANGLES else None
    modulus = column.modulus if isinstance(column, PositionColumn) else None
    speed = values.get("velocity") if key == "position" else None
    seconds = clock.seconds[known]
    own = float(np.median(np.diff(seconds))) if len(known) > 1 else 0.0
    slower = own > SLOWER * clock.period
    track = Track(
        values[key][known],
        seconds,
        own if slower else clock.period,
        max(clock.longest, bridged(own)) if slower else clock.longest,
        [*(turn * k for k in TURNS if turn), *(size * 2.0**bits for bits in BITS)],
        modulus,
        None if speed is None else speed[known],
    )
    return repaired(log.where, column.column, track, said), known
