"""What a sweep over the configuration found, or how to run one."""

from collections.abc import Sequence
from typing import Any

from spirob.report.data import ReportData
from spirob.report.sections import Section
from spirob.report.words import MISSING, column

MOST_ROWS = 200


class Sweep(Section):
    """The table of points as the sweep wrote it."""

    order = 70
    title = "Sweep"
    template = "sweep.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        if data.sweep is None:
            return {"columns": [], "rows": [], "left_out": 0, "reason": data.absent["sweep"]}
        rows = data.sweep["rows"]
        columns = [cells(values) for values in zip(*rows[:MOST_ROWS], strict=True)]
        return {
            "columns": data.sweep["columns"],
            "rows": list(zip(*columns, strict=True)),
            "left_out": max(len(rows) - MOST_ROWS, 0),
            "reason": "",
        }


def cells(values: Sequence[Any]) -> list[tuple[str, bool]]:
    """Texts of one column, and whether they are numbers and stand to the right."""
    kinds = {type(value) for value in values if value is not None}
    if kinds <= {int, float} and float in kinds:
        return [(text, True) for text in column(list(values))]
    return [(_plain(value), kinds == {int}) for value in values]


def _plain(value: Any) -> str:
    if value is None:
        return MISSING
    if isinstance(value, bool):
        return "yes" if value else "no"
    return str(value)
