"""An arm as it was measured: a table of its units and holes, in millimetres, from base to tip.

A row for each unit:

    unit        its number, 1 at the base
    length_mm   from its hinge to the next, along the axis; of the last one to the tip
    width_mm    across its middle
    edge_mm     length of its outer edge; the faces are slanted by tan α = (length - edge)/width
    near_x_mm, near_y_mm  mouth of the tendon's hole that is nearer to the base: from the unit's
                          hinge towards the tip, and from the axis
    far_x_mm, far_y_mm    mouth nearer to the tip, from the same hinge

A row of unit 0 gives the mount's hole, `far_x_mm` below 0 as it lies behind the first hinge;
without it that is the mirror image of the first unit's.  Both sides of the arm are alike.
"""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from spirob import files
from spirob.errors import ConfigError
from spirob.geometry import UNITS, Drawing, SpiralArm

COLUMNS = (
    *("unit", "length_mm", "width_mm", "edge_mm"),
    *("near_x_mm", "near_y_mm", "far_x_mm", "far_y_mm"),
)
MOUNT = ("unit", "far_x_mm", "far_y_mm")  # columns of unit 0
LARGEST = 2**18  # bytes of a table
MILLIMETRES = (0.1, 2000.0)  # that a unit's length and width may have
SLOP = 0.02  # of a unit's length, by which a hole's mouth may stand out of a face


class Unit(NamedTuple):
    """A row of the table, in metres."""

    length: float
    width: float
    edge: float
    near_x: float
    near_y: float
    far_x: float
    far_y: float


@dataclass(frozen=True)
class Measured:
    """The units of a table, and the mount's hole.

    mount  (x, y) from the first hinge [m]; None where it mirrors the first unit's

    Raises ConfigError, naming unit and column, for an arm that cannot be.
    """

    rows: tuple[Unit, ...]
    mount: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if not UNITS[0] <= len(self.rows) <= UNITS[1]:
            raise ConfigError(f"{len(self.rows)} units; an arm has {UNITS[0]} to {UNITS[1]}")
        for k, row in enumerate(self.rows):
            if flaw := _flaw(row):
                raise ConfigError(f"unit {k + 1}: {flaw}")
        if self.mount is not None:
            x, y = self.mount
            if x > 0.0 or not 0.0 < y < self.rows[0].width / 2:
                raise ConfigError(
                    f"unit 0: the mount's hole at {1e3 * x:g}, {1e3 * y:g} mm lies behind the "
                    "first hinge, far_x_mm <= 0, and within the first unit's width"
                )

    @classmethod
    def from_rows(cls, rows: Sequence[Sequence[Any]]) -> "Measured":
        """From rows as in the table, cells in the order of `COLUMNS`, in mm."""
        cells = [_cells(k, row) for k, row in enumerate(rows)]
        mount = None
        if cells and cells[0]["unit"] == 0:
            first = cells.pop(0)
            mount = (1e-3 * first["far_x_mm"], 1e-3 * first["far_y_mm"])
        for k, row in enumerate(cells, start=1):
            if row["unit"] != k:
                raise ConfigError(f"unit {k} is missing: in its place stands unit {row['unit']:g}")
        found = tuple(Unit(*(1e-3 * row[name] for name in COLUMNS[1:])) for row in cells)
        return cls(found, mount)

    @property
    def units(self) -> int:
        """Of the table."""
        return len(self.rows)

    @property
    def length(self) -> float:
        """Of the straight arm [m]."""
        return sum(row.length for row in self.rows)

    def arm(self, units: int | None = None) -> SpiralArm:
        """Its lengths, in SI; cut otherwise, outline and tendon are drawn between those measured.

        The tendon's guides lie on the faces then.
        """
        return self._whole() if units in (None, self.units) else self._cut(int(units or 0))

    def _whole(self) -> SpiralArm:
        length, width, edge, near_x, near_y, far_x, far_y = np.array(self.rows).T
        near, far = np.column_stack([near_x, near_y]), np.column_stack([far_x - length, far_y])
        mount = (-near_x[0], near_y[0]) if self.mount is None else self.mount
        return SpiralArm(
            unit_angle=2 * np.arctan((length - edge) / width),
            scale=width / width[0],
            unit_length=length,
            hinge_position=np.concatenate([[0.0], np.cumsum(length)[:-1]]),
            half_width=width / 2,
            guide_before=np.vstack([mount, far[:-1]]),
            guide_after=near,
        )

    def _cut(self, units: int) -> SpiralArm:
        whole, ends = self._whole(), np.arange(self.units + 1)
        cuts = np.linspace(0.0, self.units, units + 1)
        hinge = np.interp(cuts, ends, np.append(whole.hinge_position, whole.length))
        turned = np.interp(cuts, ends, np.concatenate([[0.0], np.cumsum(whole.unit_angle)]))
        middle = (cuts[1:] + cuts[:-1]) / 2
        half_width = np.exp(_through(middle, ends[:-1] + 0.5, np.log(whole.half_width)))
        origin = np.column_stack([whole.hinge_position, np.zeros(self.units)])
        mouths = np.stack([whole.guide_before + origin, whole.guide_after + origin], axis=1)
        line = mouths.reshape(-1, 2).T
        angle = np.diff(turned)
        inset = np.tan(angle / 2) * _through(hinge[:-1], *line)
        before, after = (
            np.column_stack([x, _through(hinge[:-1] + x, *line)]) for x in (-inset, inset)
        )
        face = np.tan(whole.unit_angle[0] / 2) * whole.guide_before[0, 1]
        before[0] = whole.guide_before[0] + [face - inset[0], 0.0]  # as far behind its face
        return SpiralArm(
            unit_angle=angle,
            scale=half_width / half_width[0],
            unit_length=np.diff(hinge),
            hinge_position=hinge[:-1],
            half_width=half_width,
            guide_before=before,
            guide_after=after,
        )


Geometry = Drawing | Measured


def with_table(given: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """A rig's `geometry` with the rows of its table in place of the table's name.

    given  `{table: NAME}`, or anything else, which is left as it is
    folder in which, or below which, the table lies

    Raises MissingLog, DataError and ConfigError, naming the file and the row.
    """
    if "table" not in given:
        return dict(given)
    if strange := sorted(set(given) - {"table"}):
        raise ConfigError(f"geometry: {', '.join(strange)}: has no place beside a table")
    if not isinstance(given["table"], str):
        raise ConfigError(f"geometry.table: a file's name, got {str(given['table'])[:40]!r}")
    path = files.inside(given["table"], folder, "geometry.table")
    text = files.content(path, "table of units", LARGEST)
    try:
        rows = list(csv.reader(io.StringIO(text.decode("utf-8-sig"))))
    except (UnicodeDecodeError, csv.Error) as error:
        raise ConfigError(f"{path}: is no CSV: {error}") from None
    try:
        return {"rows": _by_column(rows)}
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from None


def _by_column(rows: list[list[str]]) -> list[list[float | None]]:
    """The cells below the header, in the order of `COLUMNS`; empty ones are None."""
    header = [" ".join(name.split()) for name in rows[0]] if rows else []
    for name in COLUMNS:
        if header.count(name) != 1:
            said = "is missing" if name not in header else "stands twice"
            raise ConfigError(f"column '{name}' {said}; it has: {', '.join(header)[:200]}")
    found = []
    for line, row in enumerate(rows[1:], start=2):
        if not any(cell.strip() for cell in row):
            continue
        if len(row) != len(header):
            raise ConfigError(f"row {line} has {len(row)} cells, the header {len(header)}")
        found.append([_parsed(row[header.index(name)], line, name) for name in COLUMNS])
    Measured.from_rows(found)
    return found


def _parsed(cell: str, line: int, name: str) -> float | None:
    try:
        return float(cell) if cell.strip() else None
    except ValueError:
        raise ConfigError(f"row {line}, {name}: {cell.strip()[:40]!r} is no number") from None


def _cells(k: int, row: Sequence[Any]) -> dict[str, float]:
    """One row by column; raises where a number is missing or none."""
    if isinstance(row, str) or not isinstance(row, Sequence) or len(row) != len(COLUMNS):
        raise ConfigError(f"row {k + 1}: {len(COLUMNS)} numbers are needed: {', '.join(COLUMNS)}")
    cells = dict(zip(COLUMNS, row, strict=True))
    needed = MOUNT if cells["unit"] == 0 else COLUMNS
    for name in needed:
        value = cells[name]
        fit = isinstance(value, int | float) and not isinstance(value, bool)
        if not fit or not np.isfinite(value):
            who = f"unit {cells['unit']:g}" if name != "unit" else f"row {k + 1}"
            raise ConfigError(f"{who}: {name}: a number is needed, got {value!r:.40}")
    return {name: float(cells[name]) for name in needed}


def _flaw(unit: Unit) -> str:
    """What cannot be of a unit; empty where all can be."""
    length, width, edge = 1e3 * unit.length, 1e3 * unit.width, 1e3 * unit.edge
    for name, size in (("length_mm", length), ("width_mm", width)):
        if not MILLIMETRES[0] <= size <= MILLIMETRES[1]:
            return f"{name} = {size:g} is out of range {list(MILLIMETRES)}"
    if edge <= 0.0:
        return f"edge_mm = {edge:g}: its faces cross"
    if edge >= length:
        return f"edge_mm = {edge:g} is not below length_mm = {length:g}"
    if unit.near_x >= unit.far_x:
        return f"near_x_mm = {1e3 * unit.near_x:g} is not nearer to the base than far_x_mm"
    ends = {"near": (unit.near_x, unit.near_y), "far": (unit.length - unit.far_x, unit.far_y)}
    for end, (x, y) in ends.items():
        if not 0.0 < 2 * y < unit.width:
            return f"{end}_y_mm = {1e3 * y:g}: the hole lies outside of the unit"
        out = (length - edge) / width * y - x
        if out > SLOP * unit.length:
            return f"{end}_x_mm: the hole's mouth stands {1e3 * out:.3g} mm out of its face"
    return ""


def _through(at: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Values at `at` on straight lines through points, the first and last of which go on."""
    k = np.clip(np.searchsorted(x, at) - 1, 0, len(x) - 2)
    return np.asarray(y[k] + (at - x[k]) * (y[k + 1] - y[k]) / (x[k + 1] - x[k]))
