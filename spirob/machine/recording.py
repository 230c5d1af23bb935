"""One trial of a rig: motion and effort in SI, filtered and differentiated alike.

Position, and with it speed and acceleration by central differences, and the effort pass one
zero-phase Butterworth filter of 4th order; products are built from what it leaves.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.integrate import cumulative_trapezoid

from spirob.errors import MissingChannel
from spirob.logs.readers import read_table
from spirob.machine import checks
from spirob.machine.filtering import (
    ALIAS,
    BELOW,
    averaged,
    before_thinning,
    derivative,
    rates,
    smooth,
)
from spirob.machine.motion_noise import acceleration_noise, usual_cutoff
from spirob.machine.rig import TIME_UNITS, Column, RigFile
from spirob.machine.rows import usable
from spirob.units import UNITS

FINEST = 1000.0  # Hz; no filter passes what is faster, and kernels run at every sample
CLOSE = 2.5  # times the last filter's edge: thinning folds nothing from beyond


@dataclass
class Piece:
    """An uninterrupted stretch of a trial on an even grid, each array (n,).

    seconds  since the trial began;  q, v, a  position, speed, acceleration [m or rad]
    effort   filtered;  raw  unfiltered effort;  use  rows that are compared
    noise    deviation of the sensor's noise in `a`
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
    noise: float = 0.0
    others: dict[str, np.ndarray] = field(default_factory=dict)
    reference: np.ndarray | None = None


@dataclass
class Recording:
    """A trial: its pieces, sample period [s], filter, and what was repaired while reading it.

    log  file that it is of, where its own name says which part of it
    """

    name: str
    period: float
    cutoff: float
    every: int
    pieces: list[Piece]
    said: list[str]
    log: str = ""

    def smooth(self, values: np.ndarray) -> np.ndarray:
        """What the filter leaves of a signal on this grid, same length."""
        return smooth(values, self.cutoff, self.period)

    def last(self, values: np.ndarray) -> np.ndarray:
        """The last filter, which measured and modelled effort pass before thinning, same length.

        The measured effort has passed `smooth`, a product or a sign of smoothed motion has not.
        So what is compared lies well below that filter's edge, where it changes nothing.
        """
        alias = ALIAS / (self.every * self.period)
        edge = BELOW * self.cutoff
        if self.every > 1 and alias <= edge:
            return before_thinning(values, self.every)
        out = smooth(values, edge, self.period)
        return before_thinning(out, self.every) if alias < CLOSE * edge else out


def read_trial(path: Path | str, rig: RigFile, cutoff: float | None = None) -> Recording:
    """A log as a recording; `cutoff` overrides the rig's where trials are to be filtered alike.

    Raises MissingChannel and DataError in a sentence that names the file.
    """
    wanted = [column.column for column in _wanted(rig).values()]
    table = read_table(path, wanted, getattr(rig, "dbc", None))
    for name in wanted:
        table.column(name)
    time = rig.time.model_copy(update={"unit": table.units.get(rig.time.column, rig.time.unit)})
    rig = rig.model_copy(update={"time": time})
    return prepare(table.name, table.columns, rig, table.said, cutoff)


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
    columns = dict(columns)
    for column in (c for key, c in wanted.items() if key in ("effort", "velocity")):
        raw = np.asarray(columns[column.column], float)
        columns[column.column] = checks.signed(name, column.column, raw, said)
    seconds = _scaled(rig.time, columns) * TIME_UNITS[rig.time.unit]
    values = {key: _scaled(column, columns) for key, column in wanted.items() if key != "time"}
    if rig.position is not None:
        values["raw position"] = np.asarray(columns[rig.position.column], float)
    seconds, values = checks.regular_time(name, seconds, values, said)
    raw_position = values.pop("raw position", None)
    for key in values:
        values[key] = checks.finite(name, wanted[key].column, values[key], said)
    for key in {rig.motion_key, "effort"} & set(values):
        checks.moving(name, wanted[key].column, values[key])
    if rig.position is not None and raw_position is not None:
        values["position"] = checks.position(
            name, rig.position.column, values["position"], raw_position, seconds, said
        )
    values = {key: _si(rig, key) * value for key, value in values.items()}
    period, grids = checks.regular_grid(name, seconds, values, said)
    period, grids = _no_finer(name, period, grids, rig, said)
    grids = [_completed(grid, rig, period) for grid in grids]
    said += _computed(name, rig)
    cutoff = cutoff or rig.filter.cutoff or _cutoff(grids, period)
    every = rig.filter.decimate or max(1, int(1.0 / (period * 2.0 * CLOSE * cutoff)))
    pieces = [_piece(name, grid, rig, period, cutoff, said) for grid in grids]
    used = sum(int(p.use.sum()) for p in pieces) * period
    checks.enough(name, used)
    return Recording(name, period, cutoff, every, pieces, said, name)


def _no_finer(
    name: str, period: float, grids: list[dict[str, np.ndarray]], rig: RigFile, said: list[str]
) -> tuple[float, list[dict[str, np.ndarray]]]:
    """Grids of at most about a kilohertz, or of twenty samples in a period of a fast filter."""
    finest = max(FINEST, 20.0 * (rig.filter.cutoff or 0.0))
    count = int(1.0 / (period * finest) + 0.1)  # clocks differ by less between trials
    if count < 2:
        return period, grids
    said.append(
        f"{name}: means of {count} samples in a row were used, {1 / (count * period):.4g} Hz."
    )
    return count * period, [{n: averaged(v, count) for n, v in g.items()} for g in grids]


def _wanted(rig: RigFile) -> dict[str, Column]:
    found: dict[str, Column] = {"time": rig.time}
    single = {"position": rig.position, "velocity": rig.velocity, "reference": rig.reference}
    found |= {key: column for key, column in single.items() if column is not None}
    if rig.effort.source == "column":
        found["effort"] = rig.effort
    if isinstance(rig.effort.supply, Column):
        found["supply"] = rig.effort.supply
    if not isinstance(rig.body, str):
        found |= {f"joint {name}": column for name, column in rig.body.joints.items()}
    return found


def _scaled(column: Column, columns: Mapping[str, np.ndarray]) -> np.ndarray:
    return column.factor * (np.asarray(columns[column.column], float) - column.zero)


def _si(rig: RigFile, key: str) -> float:
    """SI for one unit of a channel."""
    if key == "effort":
        return rig.effort.scale
    if key == "supply" and isinstance(rig.effort.supply, Column):
        return UNITS[rig.effort.supply.unit].factor
    if key.startswith("joint ") and not isinstance(rig.body, str):
        return UNITS[rig.body.joints[key.removeprefix("joint ")].unit].factor
    column = {"velocity": rig.velocity, "reference": rig.reference}.get(key) or rig.motion
    return column.scale


def _completed(grid: dict[str, np.ndarray], rig: RigFile, period: float) -> dict[str, np.ndarray]:
    """A piece on its grid with what the log has no column for: position, effort of a controller."""
    if "position" not in grid:
        path = cumulative_trapezoid(grid["velocity"], dx=period, initial=0.0)
        grid = {**grid, "position": np.asarray(path)}
    if rig.control is not None and "effort" not in grid:
        p, d, i, a, b = rig.control.gains
        wrong = grid["reference"] - grid["position"]
        v = grid["velocity"] if "velocity" in grid else derivative(grid["position"], period)
        wound = cumulative_trapezoid(a * wrong - b * v, dx=period, initial=0.0)
        asked = p * wrong - d * v + i * np.asarray(wound)
        most = np.inf if rig.control.limit is None else rig.control.limit
        grid = {**grid, "effort": rig.effort.scale * np.clip(asked, -most, most)}
    if "supply" in grid:
        grid = {**grid, "effort": grid["effort"] * grid["supply"]}
    return grid


def _computed(name: str, rig: RigFile) -> list[str]:
    """Sentences about what was computed, not read."""
    said = []
    if rig.position is None:
        said.append(f"{name}: has a velocity alone; what depends on position cannot be told.")
    if rig.effort.source == "control":
        said.append(
            f"{name}: its effort was not logged but computed from the controller's gains and error."
        )
    return said


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
        v, a = given, derivative(given, period)
    effort = smooth(grid["effort"], cutoff, period)
    others = {}
    for key, values in grid.items():
        if key.startswith("joint "):
            angle = smooth(values, cutoff, period)
            others[key.removeprefix("joint ")] = np.column_stack([angle, *rates(angle, period)])
    share = grid["effort"] / grid["supply"] if "supply" in grid else grid["effort"]
    use = usable(name, share, v, rig, period, cutoff, said)
    noise = acceleration_noise(*_differentiated(grid), cutoff, period)
    return Piece(
        grid["time"], q, v, a, effort, grid["effort"], use, noise, others, grid.get("reference")
    )


def _differentiated(grid: Mapping[str, np.ndarray]) -> tuple[np.ndarray, int]:
    """The signal that acceleration is taken from, and how often it is differentiated."""
    return (grid["velocity"], 1) if "velocity" in grid else (grid["position"], 2)


def _cutoff(grids: list[dict[str, np.ndarray]], period: float) -> float:
    longest = max(grids, key=lambda grid: len(grid["time"]))
    return usual_cutoff(*_differentiated(longest), longest["effort"], period)
