"""The first screen: the verdict, how much it explains, and the arm in motion."""

from typing import Any

from spirob.report import arm, figures
from spirob.report.data import ReportData
from spirob.report.numbers import EFFORT, column, is_number, percent
from spirob.report.sections.section import Section

KINDS = {
    "named": "A missing effect is named",
    "undecided": "These data cannot decide",
    "nothing_missing": "Nothing is missing",
    "unknown": "Something is missing that the library does not hold",
}


class Verdict(Section):
    """Two sentences, the ladder of errors and the model's arm."""

    order = 10
    title = "Verdict"
    template = "verdict.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        diagnosis = data.diagnosis
        unit, rungs = diagnosis["unit"], diagnosis["ladder"]
        noise_floor = diagnosis.get("noise_floor")
        return {
            "kind": KINDS.get(diagnosis["verdict"], diagnosis["verdict"]),
            "sentence": diagnosis["sentence"],
            "gain": gain_sentence(rungs, noise_floor, unit),
            "ladder": figures.Plot(
                "rungs",
                "Bars of the held-out error of each model; the table of section Ladder has them",
                figures.ladder(rungs, noise_floor, unit),
            ),
            "arm": None if data.motion is None else arm.payload(data.motion),
            "no_arm": data.absent.get("motion", ""),
            "score": data.score,
        }


def gain_sentence(rungs: list[dict[str, Any]], noise_floor: float | None, unit: str) -> str:
    """The second sentence: what the named effects take off the held-out error."""
    if not rungs or not is_number(before := heldout(rungs[0])):
        return "No held-out error was recorded."
    effort = EFFORT.get(unit, "effort")
    # the first with most effects: a flexible residual on top of them is a ceiling, not a model
    grown = max(rungs, key=lambda rung: len(rung.get("effects") or ()))
    after = heldout(grown) if grown.get("effects") else None
    numbers = column([before, after, noise_floor], 2)
    floor = f"; sensor noise alone is {numbers[2]} {unit}" if is_number(noise_floor) else ""
    if after is None or not is_number(after) or before <= 0:
        return f"On held-out trials the base model's {effort} is off by {numbers[0]} {unit}{floor}."
    if after < before:
        change = f"falls from {numbers[0]} to {numbers[1]} {unit}, by {percent(1 - after / before)}"
    else:
        change = f"does not fall ({numbers[0]} before, {numbers[1]} {unit} after)"
    return f"On held-out trials the RMSE of {effort} {change}{floor}."


def heldout(rung: dict[str, Any]) -> float | None:
    """Held-out RMSE of a rung, if it has one."""
    return (rung.get("heldout") or {}).get("rmse")
