"""Pushes felt by the current alone: how many, how soon, how wrongly, and where along the arm."""

from collections.abc import Mapping
from typing import Any

from spirob.report.data import ReportData
from spirob.report.sections import Section
from spirob.report.words import MISSING, fixed, percent

REGIONS = ("base", "middle", "tip")
FELT = {"outer": "felt at the outer half", "all": "felt anywhere"} | {
    region: f"felt at the {region}" for region in REGIONS
}
AIMS = {"outer": "≥ 95 %", "alarms": "≤ 1 a minute", "right": "≥ 80 %"}


class Passive(Section):
    """The detector of pushes in the model it is learned in, and on the robot."""

    order = 58
    title = "Pushes felt by the current"
    template = "passive.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        found = data.passive or {}
        sides = [found.get(side, {}) for side in ("model", "robot")]
        return {
            "learned": found.get("learned_from"),
            "pushes": [fixed(side.get("pushes"), 0) for side in sides],
            "rows": rows(*sides) if found else [],
            "regions": REGIONS,
            "told": sides[1].get("regions", []),
            "reason": data.absent.get("passive", ""),
        }


def rows(model: Mapping[str, Any], robot: Mapping[str, Any]) -> list[dict[str, Any]]:
    """A row for each figure: model, robot, aim."""
    sides = (model, robot)
    out = [
        _row(what, [_share(side.get("felt", {}).get(key)) for side in sides], AIMS.get(key, ""))
        for key, what in FELT.items()
    ]
    alarms = [fixed(side.get("false_alarms_per_minute"), 1) for side in sides]
    out.append(_row("false alarms a minute", alarms, AIMS["alarms"]))
    out.append(_row("minutes of no push", [fixed(side.get("minutes"), 1) for side in sides]))
    for k, what in enumerate(("median", "95 %")):
        delays = [(side.get("delay_ms") or (None, None))[k] for side in sides]
        out.append(_row(f"until felt, {what} [ms]", [fixed(one, 0) for one in delays]))
    right = [_share(side.get("region_right")) for side in sides]
    return [*out, _row("region right, of those felt", right, AIMS["right"])]


def _row(what: str, cells: list[str], aim: str = "") -> dict[str, Any]:
    return {"what": what, "cells": cells, "aim": aim}


def _share(value: float | None) -> str:
    return MISSING if value is None else percent(value)
