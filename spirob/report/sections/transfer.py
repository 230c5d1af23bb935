"""Closing the loop: size learned from a better model is told better on the robot."""

import math
from typing import Any

import plotly.graph_objects as go

from spirob.report.data import ReportData
from spirob.report.figures import BASE, INK, NAMED, NEUTRAL, Plot, blank
from spirob.report.sections import Section
from spirob.report.words import fixed, is_number, number, percent, unit_text

PLAYED = {"robot": "the model itself", "machines": "many builds about it"}
STEPS = {
    "nominal": ("before any measurement", NEUTRAL),
    "identified": ("identified", BASE),
    "named": ("with the named effect", NAMED),
}
DOMAINS = {"simulation": "Simulation, continuous sizes", "robot": "Robot"}


class Transfer(Section):
    """Error on the robot for each model that size was learned from, and what intervals hold."""

    order = 62
    title = "Closing the loop"
    template = "transfer.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        if data.transfer is None:
            empty: dict[str, Any] = {
                "rows": [],
                "machines": False,
                "plot": None,
                "coverage": [],
                "confidence": "",
                "honest": "",
                "falls": False,
                "samples": "",
                "stood_in": "",
            }
            return {**empty, "reason": data.absent["transfer"]}
        steps = {name: data.transfer["robot"][name] for name in STEPS}
        errors = [step["mae"] for step in steps.values()]
        interval = data.transfer.get("interval") or {}
        about = data.transfer.get("machines") or {}
        return {
            "rows": [_row(name, step, "robot") for name, step in steps.items()]
            + [_row(name, about[name], "machines") for name in STEPS if name in about],
            "machines": bool(about),
            "plot": Plot(
                "transfer-error", "Error of size on the robot, model by model", _bars(steps, about)
            ),
            "coverage": [_coverage(d, interval[d]) for d in DOMAINS if d in interval],
            "confidence": percent(interval.get("confidence")),
            "honest": held(interval),
            "falls": errors == sorted(errors, reverse=True),
            "samples": fixed(data.transfer["samples"], 0),
            "stood_in": "; ".join(_moved(one) for one in data.transfer.get("stood_in", [])),
            "reason": "",
        }


def _moved(one: dict[str, Any]) -> str:
    stood, stands = number(one["identified"]), number(one["named"])
    unit = "" if one["unit"] == "1" else f" {unit_text(one['unit'])}"
    bound = ", where its bound held it," if one.get("at_bound") else ""
    return f"{one['meaning'].split(';')[0]} {stood}{bound} for {stands}{unit}"


def held(interval: dict[str, Any]) -> str:
    """Whether the robot's sizes lie in their intervals as often as was promised."""
    robot = interval.get("robot") or {}
    said, found = interval.get("confidence"), robot.get("covered")
    if not (is_number(said) and is_number(found)):
        return ""
    chance = 2 * math.sqrt(said * (1 - said) / max(robot["samples"], 1))  # two standard deviations
    if found > said - chance:
        return ""
    return (
        f"On the robot they hold only {percent(found)} of the sizes: they were set in simulation "
        "and do not know how the robot differs from it."
    )


def _row(name: str, step: dict[str, Any], played: str) -> dict[str, Any]:
    gain = "–"
    if "gain" in step:
        gain = f"{fixed(step['gain'], 2)} ({_span(step, 'gain_low', 'gain_high')})"
    errors = f"{fixed(step['mae'], 2)} ({_span(step, 'mae_low', 'mae_high')})"
    cells = [errors, fixed(step["rmse"], 2), fixed(step["r2"], 3), gain]
    return {"name": STEPS[name][0], "played": PLAYED[played], "cells": cells}


def _span(step: dict[str, Any], low: str, high: str) -> str:
    return f"{fixed(step[low], 2)} to {fixed(step[high], 2)}"


def _coverage(domain: str, found: dict[str, Any]) -> dict[str, Any]:
    width = fixed(1e3 * found["width"], 1)
    cells = [
        fixed(found["samples"], 0),
        percent(found["covered"]),
        width,
        percent(found["refused"]),
    ]
    return {"domain": DOMAINS[domain], "cells": cells}


def _bars(steps: dict[str, Any], about: dict[str, Any]) -> go.Figure:
    figure = blank(230 if not about else 300, bargap=0.3)
    for played, errors, pattern in (("robot", steps, ""), ("machines", about, "/")):
        if errors:
            _add_bars(figure, PLAYED[played], errors, pattern, bool(about))
    figure.update_layout(legend={"traceorder": "normal"})
    figure.update_yaxes(autorange="reversed", showgrid=False, ticklabelstandoff=6)
    figure.update_xaxes(title_text="mean absolute error on the robot [mm]", rangemode="tozero")
    return figure


def _add_bars(
    figure: go.Figure, played: str, steps: dict[str, Any], pattern: str, legend: bool
) -> None:
    above = [step["mae_high"] - step["mae"] for step in steps.values()]
    below = [step["mae"] - step["mae_low"] for step in steps.values()]
    spread = {"type": "data", "array": above, "arrayminus": below, "color": INK, "thickness": 1.2}
    figure.add_bar(
        x=[step["mae"] for step in steps.values()],
        y=[STEPS[name][0] for name in steps],
        name=f"played by {played}",
        orientation="h",
        marker={"color": [STEPS[name][1] for name in steps], "pattern": {"shape": pattern}},
        error_x=spread,
        hovertemplate="%{x:.2f} mm<extra>%{y}, " + played + "</extra>",
        showlegend=legend,
    )
