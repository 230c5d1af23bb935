"""One trial of a rig: motion and effort in SI, filtered and differentiated alike.

Position, and with it speed and acceleration by central differences, and the effort pass one
zero-phase Butterworth filter of 4th order; products are built from what it leaves.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
from scipy import signal

from spirob.errors import DataError, MissingChannel
from spirob.machine import checks
from spirob.machine.reading import read_columns
from spirob.machine.rig import ANGLES, EFFORTS, LENGTHS, TIME_UNITS, Column, RigFile

FULL = 0.98  # of the drive's limit counts as saturated
STUCK = 5  # equal extreme values in a row are a limit that nobody declared


@dataclass
class Piece:
    """An uninterrupted stretch of a trial on an even grid, each array (n,).

    seconds  since the trial began;  q, v, a  position, speed, acceleration [m or rad]
    effort   filtered;  raw  unfiltered effort;  use  rows that are compared
    others   further joints by name, (n, 3): position, speed, acceleration
    reference  commanded position, where the rig has one
    """

    seconds: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    effort: np.ndarray
    raw: np.ndarray
    use: np.ndarray
    others: dict[str, np.ndarray] = field(default_factory=dict)
    reference: np.ndarray | None = None


@dataclass
class Recording:
    """A trial: its pieces, sample period [s], filter, and what was repaired while reading it."""

    name: str
    period: float
    cutoff: float
    every: int
    pieces: list[Piece]
    said: list[str]

    def smooth(self, values: np.ndarray) -> np.ndarray:
        """What the filter leaves of a signal on this grid, same length."""
        return smooth(values, self.cutoff, self.period)

    def last(self, values: np.ndarray) -> np.ndarray:
        """The filter before thinning, which measured and modelled effort pass, same length.

        A product of filtered signals, such as a sign, is no longer band-limited; thinned as it is,
        it would fold into the band that is compared.
        """
        if self.every == 1:
            return self.smooth(values)
        padding = min(60, len(values) - 1)
        return np.asarray(signal.sosfiltfilt(_before_thinning(self.every), values, padlen=padding))


def smooth(values: np.ndarray, cutoff: float, period: float) -> np.ndarray:
    """Zero-phase Butterworth filter of 4th order; above half the sample rate it passes all."""
    if cutoff * period >= 0.49:
        return values
    padding = min(30, len(values) - 1)
    return np.asarray(signal.sosfiltfilt(_low_pass(cutoff, period), values, padlen=padding))


@cache
def _low_pass(cutoff: float, period: float) -> np.ndarray:
    return np.asarray(signal.butter(4, cutoff, fs=1.0 / period, output="sos"))


@cache
def _before_thinning(every: int) -> np.ndarray:
    return np.asarray(signal.cheby1(8, 0.05, 0.8 / every, output="sos"))  # scipy.signal.decimate


def read_trial(path: Path | str, rig: RigFile, cutoff: float | None = None) -> Recording:
    """A log as a recording; `cutoff` overrides the rig's where trials are to be filtered alike.

    Raises MissingChannel and DataError in a sentence that names the file.
    """
    path = Path(path)
    columns, said = read_columns(path)
    return prepare(path.name, columns, rig, said, cutoff)


def prepare(
    name: str,
    columns: Mapping[str, np.ndarray],
    rig: RigFile,
    said: list[str] | None = None,
    cutoff: float | None = None,
) -> Recording:
    """Columns in the log's own units as a recording in SI."""
    said = [] if said is None else said
    wanted = _wanted(rig)
    for column in wanted.values():
        if column.column not in columns:
            raise MissingChannel(name, column.column, list(columns))
    seconds = _scaled(rig.time, columns) * TIME_UNITS[rig.time.unit]
    values = {key: _scaled(column, columns) for key, column in wanted.items() if key != "time"}
    raw_position = np.asarray(columns[rig.position.column], float)
    seconds, values = checks.regular_time(
        name, seconds, {**values, "raw position": raw_position}, said
    )
    raw_position = values.pop("raw position")
    for key in values:
        values[key] = checks.finite(name, wanted[key].column, values[key], said)
    for key in ("position", "effort"):
        checks.moving(name, wanted[key].column, values[key])
    values["position"] = checks.position(
        name, rig.position.column, values["position"], raw_position, seconds, said
    )
    values = {key: _si(rig, key) * value for key, value in values.items()}
    period, grids = checks.regular_grid(name, seconds, values, said)
    cutoff = cutoff or rig.filter.cutoff or _usual_cutoff(period)
    every = rig.filter.decimate or max(1, int(1.0 / (period * 10.0 * cutoff)))
    pieces = [_piece(name, grid, rig, period, cutoff, said) for grid in grids]
    used = sum(int(p.use.sum()) for p in pieces) * period
    if used < checks.SHORTEST:
        raise DataError(f"{name}: only {used:.2g} s are left after the row filters")
    return Recording(name, period, cutoff, every, pieces, said)


def _wanted(rig: RigFile) -> dict[str, Column]:
    found: dict[str, Column] = {"time": rig.time, "position": rig.position, "effort": rig.effort}
    if rig.velocity is not None:
        found["velocity"] = rig.velocity
    if rig.reference is not None:
        found["reference"] = rig.reference
    if not isinstance(rig.body, str):
        found |= {f"joint {name}": column for name, column in rig.body.joints.items()}
    return found


def _scaled(column: Column, columns: Mapping[str, np.ndarray]) -> np.ndarray:
    return column.factor * (np.asarray(columns[column.column], float) - column.zero)


def _si(rig: RigFile, key: str) -> float:
    units = LENGTHS | ANGLES
    if key == "effort":
        return EFFORTS[rig.effort.kind][rig.effort.unit]
    if key.startswith("joint ") and not isinstance(rig.body, str):
        return units[rig.body.joints[key.removeprefix("joint ")].unit]
    if key == "velocity" and rig.velocity is not None:
        return units[rig.velocity.unit.removesuffix("/s")]
    return units[rig.position.unit]


def _usual_cutoff(period: float) -> float:
    # motors move their load within tens of milliseconds; twenty samples a period keep it clean
    return min(50.0, 0.05 / period)


def _piece(
    name: str,
    grid: dict[str, np.ndarray],
    rig: RigFile,
    period: float,
    cutoff: float,
    said: list[str],
) -> Piece:
    q = smooth(grid["position"], cutoff, period)
    v, a = rates(q, period)
    if "velocity" in grid:
        given = smooth(grid["velocity"], cutoff, period)
        checks.velocity(name, rig.velocity.column if rig.velocity else "velocity", given, v)
        v, a = given, np.gradient(given, period)
    effort = smooth(grid["effort"], cutoff, period)
    others = {}
    for key, values in grid.items():
        if key.startswith("joint "):
            angle = smooth(values, cutoff, period)
            others[key.removeprefix("joint ")] = np.column_stack([angle, *rates(angle, period)])
    use = _usable(name, grid["effort"], v, rig, period, cutoff, said)
    return Piece(grid["time"], q, v, a, effort, grid["effort"], use, others, grid.get("reference"))


def rates(q: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative by central differences."""
    v = np.gradient(q, period)
    return v, np.gradient(v, period)


def _usable(
    name: str,
    effort: np.ndarray,
    v: np.ndarray,
    rig: RigFile,
    period: float,
    cutoff: float,
    said: list[str],
) -> np.ndarray:
    use = np.ones(len(v), bool)
    drop = rig.filter.drop
    if drop is None:
        drop = round(5.0 / (cutoff * period))
    use[:drop] = False
    use[len(use) - drop :] = False
    reach = max(1, round(0.5 / (cutoff * period)))  # the filter smears what happens beside a row
    full = _saturated(effort, rig)
    if full.any():
        use &= ~_widened(full, reach)
        said.append(f"{name}: {full.mean():.1%} of the rows left out, where the drive saturates.")
    unit = _si(rig, "position")
    if rig.rows.minimum_speed is not None:
        slow = np.abs(v) < unit * rig.rows.minimum_speed
        use &= ~slow
        said.append(f"{name}: {slow.mean():.1%} of the rows left out as too slow.")
    if rig.rows.maximum_speed is not None:
        use &= np.abs(v) <= unit * rig.rows.maximum_speed
    return use


def _saturated(effort: np.ndarray, rig: RigFile) -> np.ndarray:
    if rig.effort.limit is not None:
        limit = rig.effort.limit * EFFORTS[rig.effort.kind][rig.effort.unit]
        return np.abs(effort) >= FULL * limit
    full = np.zeros(len(effort), bool)
    for extreme in (effort.max(), effort.min()):
        at = np.concatenate([[0], (effort == extreme).astype(int), [0]])
        edges = np.flatnonzero(np.diff(at))
        for start, stop in zip(edges[::2], edges[1::2], strict=True):
            if stop - start >= STUCK:
                full[start:stop] = True
    return full


def _widened(mask: np.ndarray, reach: int) -> np.ndarray:
    return np.convolve(mask, np.ones(2 * reach + 1), "same") > 0.5
