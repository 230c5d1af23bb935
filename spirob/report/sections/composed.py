"""A law composed for what no name explains: its shape, its numbers, and it over the data."""

from typing import Any

import pandas as pd
import plotly.graph_objects as go

from spirob.report.data import ReportData
from spirob.report.figures import Plot, stride
from spirob.report.sections import Section, laws
from spirob.report.sections.laws import Against, Law
from spirob.report.words import EFFORT, number

ABSENT = (
    "No law was composed: nothing that counts is left of these logs, or none of a few terms takes "
    "it on blocks and logs that no fit saw, or the data make no sense."
)
OVER = {"place": "position", "speed": "velocity", "load": "effort", "time": "time"}
FACTORS = {"way", "line", "share"}  # of a term: what is drawn is the other one


class RigComposed(Section):
    """The law's sentence, formula, table of numbers and figure."""

    order = 15
    title = "A law for what is left"
    template = "rig_composed.html.j2"
    pages = ("rig",)
    nothing = ABSENT

    @staticmethod
    def absent(context: dict[str, Any]) -> str:
        return str(context.get("absent", ""))

    def get_context(self, data: ReportData) -> dict[str, Any]:
        found = data.diagnosis.get("composed")
        if found is None or data.composed is None:
            return {"law": None, "absent": self.nothing}
        rows = [
            {
                "name": name.replace("_", " "),
                "value": number(one["value"]),
                "ends": f"{number(one['low'])} to {number(one['high'])}",
                "unit": one["unit"],
            }
            for name, one in found["numbers"].items()
        ]
        figure = drawn(data.composed, over(found), self.about(data))
        label = f"What is left without the law, and the law with its 95 % band, over {over(found)}"
        plot = Plot("composed-law", label, figure)
        return {"law": found, "numbers": rows, "plot": plot, "how": self.how(found["file"])}

    def about(self, data: ReportData) -> dict[str, Any]:
        """What the effort is called, and its unit."""
        return data.diagnosis

    def how(self, file: str) -> list[str]:
        """What switches the law on, as code, and the condition of it."""
        return [f"effects: [{file}]", "in the description, beside which the file then lies,"]


def over(found: dict[str, Any]) -> str:
    """The column of the drawing that the law depends on most plainly."""
    named = [argument for argument in OVER if argument in found["range"]]
    placed = [a for a in named if a != "speed" or found["terms"][0] in FACTORS]
    return OVER[(placed or named or ["time"])[0]]


def drawn(rows: pd.DataFrame, column: str, diagnosis: dict[str, Any]) -> go.Figure:
    """Dots of what is left and of the law, whose bars are its band."""
    axis, unit = rows["axis"].iloc[0], diagnosis["unit"]
    titles = {
        "position": f"position [{axis}]",
        "velocity": f"speed [{axis}/s]",
        "effort": f"{diagnosis['effort']} [{unit}]",
        "time": "time since the log began [s]",
    }
    x, shown, law, band = (rows[c].to_numpy(float) for c in (column, "shown", "law", "band"))
    against = Against(column, titles[column])
    figure = laws.over_signal(Law(against, x, shown, law, diagnosis["effort"], unit, 1.0))
    bars = [float(f"{b:.3g}") for b in band[:: stride(len(x), laws.MOST)]]
    figure.update_traces(
        error_y={"type": "data", "array": bars, "thickness": 1, "width": 0},
        selector={"name": "fitted law"},
    )
    return figure


class Composed(RigComposed):
    """As of a rig, where the verdict is unknown."""

    pages = ("arm",)
    nothing = (
        "No law was composed: it is asked for where something is missing that the library does not "
        "hold, and has to take what is left in trials that no fit saw."
    )

    def about(self, data: ReportData) -> dict[str, Any]:
        unit = data.diagnosis["unit"]
        return {"effort": EFFORT[unit], "unit": unit}

    def how(self, file: str) -> list[str]:
        return [f"spirob run 'plant.effects=[data/diagnosis/{file}]'", ""]
