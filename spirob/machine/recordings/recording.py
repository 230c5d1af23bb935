"""One trial of a rig: motion and effort in SI, filtered and differentiated alike.

Position, with it speed and acceleration, and effort pass one zero-phase Butterworth filter.
"""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.integrate import cumulative_trapezoid

from spirob.errors import MissingChannel, NothingLeft
from spirob.logs.readers import Table
from spirob.machine.description.rig import Column, RigFile
from spirob.machine.recordings import checks
from spirob.machine.recordings.broken_stretches import Grid, Looked, followed, without_bursts
from spirob.machine.recordings.checks import stands, usable
from spirob.machine.recordings.filtering import (
    ALIAS,
    BELOW,
    acceleration_noise,
    as_fine,
    before_thinning,
    derivative,
    least_cutoff,
    possible_cutoff,
    rates,
    roomy_cutoff,
    smooth,
    thinned,
    usual_cutoff,
)
from spirob.machine.recordings.grids import FILLED, Logged, even_grids
from spirob.machine.recordings.measured_speed import measured
from spirob.machine.recordings.saturation import Ends, saturated
from spirob.units import UNITS

FINEST = 1000.0  # Hz; no filter passes what is faster, and kernels run at every sample
GRID = 20.0  # samples in a period of the cutoff: more say no more of what is compared
CLOSE = 2.5  # times the last filter's edge: thinning folds nothing from beyond
LEAST = 8  # rows of a piece that are compared
FEWEST = 20  # rows of a trial that are compared
MOVES = 0.5  # of what the last filter makes a compared row of is motion
Filter = Callable[[np.ndarray], np.ndarray]


@dataclass
class Piece:
    """An uninterrupted stretch of a trial on an even grid, each array (n,).

    seconds  since the trial began;  path  unfiltered position
    q, v, a  position, speed, acceleration [m or rad]
    effort   filtered;  raw  unfiltered effort
    use      rows that are compared;  stands  those of a rest, which are none of them
    noise    deviation of the sensor's noise in `a`
    others   further joints by name, (n, 3): position, speed, acceleration
    reference  commanded position, where the rig has one
    """

    seconds: np.ndarray
    path: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    effort: np.ndarray
    raw: np.ndarray
    use: np.ndarray
    stands: np.ndarray
    noise: float = 0.0
    others: dict[str, np.ndarray] = field(default_factory=dict)
    reference: np.ndarray | None = None

    def part(self, rows: slice) -> "Piece":
        """These rows alone."""
        plain = {name: getattr(self, name)[rows] for name in ALONG}
        others = {name: values[rows] for name, values in self.others.items()}
        reference = None if self.reference is None else self.reference[rows]
        return replace(self, **plain, others=others, reference=reference)


ALONG = ("seconds", "path", "q", "v", "a", "effort", "raw", "use", "stands")


@dataclass
class Recording:
    """A trial: its pieces, sample period [s], filter, and what was repaired while reading it.

    log   file that it is of;  turn  [m or rad] after which its position begins again, or 0
    least  cutoff [Hz] from which on most of its motion is in what is compared
    """

    name: str
    period: float
    cutoff: float
    every: int
    pieces: list[Piece]
    said: list[str]
    log: str = ""
    turn: float = 0.0
    least: float = 0.0

    def worth(self, pieces: list[Piece]) -> list[Piece]:
        """The pieces of which some rows are compared."""
        return [p for p in pieces if np.count_nonzero(p.use[:: self.every]) >= LEAST]

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

    def moving(self, piece: Piece) -> np.ndarray:
        """Share of the last filter that lies on rows of a piece at which the axis moves, (n,)."""
        return self.last(np.where(piece.stands, 0.0, 1.0))

    def last_of(self, piece: Piece) -> Filter:
        """The last filter of a piece, over the rows at which the axis moves: Σ w x / Σ w."""
        if not piece.stands.any():
            return self.last
        moves, share = ~piece.stands, np.maximum(self.moving(piece), MOVES)
        return lambda values: np.asarray(self.last(values * moves) / share)


def of_table(
    table: Table, rig: RigFile, cutoff: float | None = None, ends: Ends | None = None
) -> Recording:
    """A log as a recording, by what all logs of the rig have: a cutoff, the ends of the efforts.

    Raises MissingChannel and DataError in a sentence that names the file; NothingLeft where others
    may do without it.
    """
    for name in rig.columns():
        table.column(name)
    rig = rig.model_copy(update={"time": rig.time.told(table.name, table.units)})
    return prepare(table.name, table.columns, rig, list(table.said), cutoff, ends)


def prepare(
    name: str,
    columns: Mapping[str, np.ndarray],
    rig: RigFile,
    said: list[str] | None = None,
    cutoff: float | None = None,
    ends: Ends | None = None,
) -> Recording:
    """Columns in the log's own units as a recording in SI; raises as `of_table` does."""
    said = [] if said is None else said
    wanted = rig.channels()
    for column in wanted.values():
        if column.column not in columns:
            raise MissingChannel(name, column.column, list(columns))
    columns = dict(columns)
    for column in (c for key, c in wanted.items() if key in ("effort", "velocity")):
        raw = np.asarray(columns[column.column], float)
        columns[column.column] = checks.signed(name, column.column, raw, said)
    inside = {key: column for key, column in wanted.items() if key != "time"}
    cells = {key: np.asarray(columns[c.column], float) for key, c in inside.items()}
    values = {key: _scaled(column, columns) for key, column in inside.items()}
    stamps = np.asarray(columns[rig.time.column], float)
    commanded = rig.effort.origin == "command"
    log = Logged(name, rig.time, stamps, inside, cells, values, commanded=commanded)
    period, grids = even_grids(log, said)
    turn = abs(_si(rig, "position")) * log.moduli.get("position", 0.0)
    for grid in grids:
        grid |= {key: _si(rig, key) * grid[key] for key in inside if key in grid}
    period, grids = _no_finer(name, period, grids, rig, said)
    grids = [_completed(grid, rig, period) for grid in grids]
    said += _computed(name, rig)
    _agreed(name, grids, rig, period, cutoff, said)
    grids = [_controlled(grid, rig, period) for grid in grids]  # by the speed that is right
    looked = _cutoff(name, grids, period, cutoff or rig.filter.cutoff, [])
    felt = Looked(name, rig.effort.column or "effort", period, looked, rig.angular)
    grids = without_bursts(felt, grids, said)
    cutoff = _cutoff(name, grids, period, cutoff or rig.filter.cutoff, said)
    grids = followed(name, rig.motion.column, grids, BELOW * cutoff, period, said)
    period, grids = as_fine(period, grids, GRID * cutoff)
    every = max(1, int(1.0 / (period * 2.0 * CLOSE * cutoff) + 1e-3))
    if rig.filter.decimate is not None:
        effort = max((grid["effort"] for grid in grids), key=len)
        every = thinned(name, (rig.filter.decimate, every), effort, cutoff, period, said)
    lost: Counter[str] = Counter()
    duty = [g["effort"] / g["supply"] if "supply" in g else g["effort"] for g in grids]
    full = saturated(name, duty, rig, ends, said)
    pieces = [_piece(*one, rig, period, cutoff, lost) for one in zip(grids, full, strict=True)]
    least = min(cutoff, max(least_cutoff(grid["position"], period) for grid in grids))
    made = Recording(name, period, cutoff, every, pieces, said, name, turn, least)
    return replace(made, pieces=_kept(made, rig, lost))


def _no_finer(
    name: str, period: float, grids: list[Grid], rig: RigFile, said: list[str]
) -> tuple[float, list[Grid]]:
    """Grids of at most about a kilohertz, or of twenty samples in a period of a fast filter."""
    finest = max(FINEST, GRID * (rig.filter.cutoff or 0.0))
    coarser, means = as_fine(period, grids, finest)
    if coarser > period:
        count = round(coarser / period)
        said.append(f"{name}: means of {count} samples in a row were used, {1 / coarser:.4g} Hz.")
    return coarser, means


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


def _completed(grid: Grid, rig: RigFile, period: float) -> Grid:
    """A piece on its grid with what the log has no column for: position, effort of a controller."""
    if "position" not in grid:
        path = cumulative_trapezoid(grid["velocity"], dx=period, initial=0.0)
        grid = {**grid, "position": np.asarray(path)}
    if rig.effort.source == "control":
        return _controlled(grid, rig, period)
    if "supply" in grid:
        grid = {**grid, "effort": grid["effort"] * grid["supply"]}
    return grid


def _controlled(grid: Grid, rig: RigFile, period: float) -> Grid:
    """A piece with the effort that its controller asks for, where the log has none."""
    if rig.control is None or rig.effort.source != "control":
        return grid
    v = grid["velocity"] if "velocity" in grid else derivative(grid["position"], period)
    goal = grid["reference"]
    asked = rig.control.asked(goal - grid["position"], derivative(goal, period), v, period)
    return {**grid, "effort": rig.effort.scale * grid.get("supply", 1.0) * asked}


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
    grid: Grid,
    full: np.ndarray,
    rig: RigFile,
    period: float,
    cutoff: float,
    lost: Counter[str],
) -> Piece:
    q = smooth(grid["position"], cutoff, period)
    v, a = rates(q, period)
    if "velocity" in grid:
        v = smooth(grid["velocity"], cutoff, period)
        a = derivative(v, period)
    effort = smooth(grid["effort"], cutoff, period)
    others = {}
    for key, values in grid.items():
        if key.startswith("joint "):
            angle = smooth(values, cutoff, period)
            others[key.removeprefix("joint ")] = np.column_stack([angle, *rates(angle, period)])
    use = usable(full, v, grid[FILLED] > 0, rig, period, cutoff, lost)
    noise = acceleration_noise(*_differentiated(grid), cutoff, period)
    measured = grid["time"], grid["position"], q, v, a, effort, grid["effort"]
    return Piece(*measured, use, np.zeros_like(use), noise, others, grid.get("reference"))


def _differentiated(grid: Mapping[str, np.ndarray]) -> tuple[np.ndarray, int]:
    """The signal that acceleration is taken from, and how often it is differentiated."""
    return (grid["velocity"], 1) if "velocity" in grid else (grid["position"], 2)


def _cutoff(
    name: str,
    grids: list[Grid],
    period: float,
    asked: float | None,
    said: list[str],
) -> float:
    """The cutoff that is asked for where it can be, or else the usual one [Hz]."""
    longest = max(grids, key=lambda grid: len(grid["time"]))
    usual = usual_cutoff(*_differentiated(longest), longest["effort"], period)
    least = least_cutoff(longest["effort"], period)
    usual = roomy_cutoff(usual, least, [grid[FILLED] > 0 for grid in grids], period)
    return possible_cutoff(name, asked, usual, period * len(longest["time"]), period, said)


def _agreed(
    name: str,
    grids: list[Grid],
    rig: RigFile,
    period: float,
    asked: float | None,
    said: list[str],
) -> None:
    """A measured speed with its scale and on the position's time; without it, where it is none."""
    if rig.velocity is None or rig.position is None or "velocity" not in grids[0]:
        return
    title = f"{name}: '{rig.velocity.column}'"
    given = [grid.pop("velocity") for grid in grids]
    cutoff = _cutoff(name, grids, period, asked or rig.filter.cutoff, [])
    places = [grid["position"] for grid in grids]
    right = measured(title, given, places, cutoff, period, said)
    for grid, values in zip(grids, right, strict=False):
        grid["velocity"] = values


def _kept(made: Recording, rig: RigFile, lost: Counter[str]) -> list[Piece]:
    """The pieces that move and of which rows are compared; what is left out is said.

    Raises NothingLeft where that is all.
    """
    rows = sum(len(p.q) for p in made.pieces)
    shares = [f"{n / rows:.1%} of the rows left out{why}" for why, n in lost.items() if n]
    span = max(float(np.ptp(p.q)) for p in made.pieces)
    moves = [p for p in made.pieces if rig.rows.standstill == "keep" or not stands(p.q, span)]
    used = sum(int(p.use.sum()) for p in moves) * made.period
    ends = f"of {rows * made.period:.3g} s a filter of {made.cutoff:.3g} Hz smears both ends"
    checks.enough(made.name, used, "; ".join([ends, *shares]))
    kept = made.worth(moves)
    compared = sum(int(p.use[:: made.every].sum()) for p in kept)
    if compared < FEWEST:
        raise NothingLeft(
            f"{made.name}: {compared} rows are compared, one of {made.every}; {FEWEST} are needed"
        )
    made.said.extend(f"{made.name}: {text}." for text in shares)
    skipped = [(len(made.pieces) - len(moves), "stand"), (len(moves) - len(kept), "hold no rows")]
    made.said.extend(f"{made.name}: {n} pieces that {why} skipped." for n, why in skipped if n)
    return kept
