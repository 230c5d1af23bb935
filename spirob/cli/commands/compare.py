"""Show how far the identified model is from trials that no fit has seen.

Brings the results up to date first, as `spirob run --until compare` does.  Motors that were held at
a constant current are marked idle.
"""

import argparse
import json
from collections.abc import Sequence
from typing import Any

from spirob.cli.reproduce import add_choices, advance
from spirob.errors import MissingLog

HELP = "how far the model is from what was measured"
ORDER = 30
SHOWN = {"current": ("mA", 1e3), "displacement": ("mm", 1e3), "velocity": ("mm/s", 1e3)}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_choices(parser)
    parser.add_argument("--as-is", action="store_true", help="show the last results, run nothing")


def run(arguments: argparse.Namespace) -> int:
    """Compare and print a table: root mean square errors and R², motor by motor."""
    from spirob.cli.project import find_project

    if arguments.as_is:
        project = find_project(arguments.project)
    else:
        code, project = advance(arguments, "compare")
        if code:
            return code
    file = project / "data/compare/compare.json"
    if not file.exists():
        raise MissingLog(f"{file} is missing; `spirob compare` without --as-is makes it")
    print(table(json.loads(file.read_text(encoding="utf-8"))["trials"]))
    return 0


def table(trials: list[dict[str, Any]]) -> str:
    """A line for each motor of each trial."""
    head = ["trial", "motor"]
    for channel, (unit, _) in SHOWN.items():
        head += [f"{channel} RMSE [{unit}]", "R²"]
    rows = []
    for trial in trials:
        for motor, about in trial["motors"].items():
            name = motor if about.get("driven", True) else f"{motor} (idle)"
            rows.append([trial["name"], name, *_cells(about)])
    return columns(head, rows, left=2)


def columns(head: Sequence[str], rows: Sequence[Sequence[str]], left: int = 1) -> str:
    """Rows under their head as aligned plain text, as people and `cut` read it.

    The first `left` columns begin flush, the others end so.
    """
    table = [list(head), *(list(row) for row in rows)]
    widths = [max(len(row[k]) for row in table) for k in range(len(head))]
    lines = []
    for row in table:
        cells = [
            cell.ljust(width) if k < left else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


def _cells(about: dict[str, Any]) -> list[str]:
    cells = []
    for channel, (_, factor) in SHOWN.items():
        errors = about.get(channel, {})
        cells.append(_number(errors.get("rmse"), factor))
        cells.append(_number(errors.get("r2"), 1.0))
    return cells


def _number(value: float | None, factor: float) -> str:
    return "–" if value is None else f"{factor * value:.4g}"
