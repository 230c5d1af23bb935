"""Each named effect of a rig over its held-out data: the two plots that show it."""

from typing import Any

import pandas as pd

from spirob.effects import all_effects
from spirob.report.data import ReportData
from spirob.report.laws import LOAD, PLACE, SPEED, TIME, Against, Law, against
from spirob.report.sections import Section
from spirob.report.sections.laws import plots, sentence

ABSENT = "Laws are drawn where an effect is named."


class RigLaws(Section):
    """For each named effect: law against residual over the signal that it depends on."""

    order = 42
    title = "Effects over the data"
    template = "laws.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        named = {effect["name"]: effect["title"] for effect in data.diagnosis["effects"]}
        shown = []
        if data.laws is not None:
            for name, rows in data.laws.groupby("effect", sort=False):
                if name in named and rows["shown"].any():
                    shown.append(_entry(str(name), named[str(name)], law_of(rows, data.diagnosis)))
        return {"effects": shown, "named": True, "reason": ABSENT}


def law_of(rows: pd.DataFrame, diagnosis: dict[str, Any]) -> Law:
    """The samples of one effect, over the signal of the rig nearest to what it depends on."""
    axis, unit = rows["axis"].iloc[0], diagnosis["unit"]
    over = {
        SPEED: ("velocity", Against("velocity", f"speed [{axis}/s]")),
        PLACE: ("position", Against("position", f"position [{axis}]")),
        LOAD: ("effort", Against("effort", f"{diagnosis['effort']} [{unit}]")),
        TIME: ("time", Against("time", "time since the log began [s]")),
    }
    column, shown_over = over[against(all_effects().get(str(rows["effect"].iloc[0])))]
    x, seen, law = (rows[name].to_numpy(float) for name in (column, "shown", "law"))
    return Law(shown_over, x, seen, law, diagnosis["effort"], unit, 1.0)


def _entry(name: str, title: str, found: Law) -> dict[str, Any]:
    return {
        "title": title,
        "sentence": sentence(found),
        "rivals": [],
        "plots": plots(name, title, found),
    }
