"""What the estimate of size rests on: its rivals, its features, the number of samples."""

from collections.abc import Mapping, Sequence
from typing import Any

import plotly.graph_objects as go

from spirob.perceive.features import FEATURES
from spirob.perceive.size import SizeSettings
from spirob.report.data import ReportData
from spirob.report.figures import BASE, NAMED, Plot, bars, blank
from spirob.report.sections import Section
from spirob.report.words import fixed

SHIPPED = "shipped: both, boosting the rest"
RIVALS = {
    "ridge": "Ridge alone",
    "svr": "SVR alone",
    "gaussian_process": "Gaussian process",
    "few": "shipped kind, the paper's wraps",
    "paper": "the paper's stack and wraps",
    "mean": "the mean of the training",
}
SIZE_DOMAINS = {
    "simulation": ("simulation", NAMED, "circle"),
    "robot": ("robot", BASE, "diamond"),
}
MAE = "mean absolute error [mm]"
TICKS = (0.5, 1, 2, 5, 10, 20)  # mm


class SizeStudy(Section):
    """The shipped predictor beside others, its learning curve, what shuffled features cost."""

    order = 61
    title = "What size rests on"
    template = "size_study.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        metrics = data.metrics.get("size") or {}
        return {
            "plots": plots(metrics),
            "better": better(metrics),
            "unlisted": unlisted(metrics.get("robot") or {}),
            "choice": choice((metrics.get("training") or {}).get("chosen") or []),
            "reason": data.absent.get("size_metrics", "This run compared no predictors."),
        }


def plots(metrics: Mapping[str, Any]) -> list[Plot]:
    """The figures that the metrics hold numbers for."""
    shown = []
    errors = side_by_side(metrics)
    if len(errors) > 1:
        label = "The shipped predictor beside others; bars are 95 % intervals over wraps"
        shown.append(Plot("size-predictors", label, predictors(errors)))
    training = metrics.get("training") or {}
    if training.get("learning_curve"):
        label = "Error over the number of wraps learned from; bars are 95 % intervals"
        figure = learning_curve(training["learning_curve"])
        shown.append(Plot("size-learning", label, figure))
    if training.get("importance"):
        label = "What it costs to shuffle one feature among the wraps"
        meanings = {name: f"{one.meaning} [{one.unit}]" for name, one in FEATURES.items()}
        figure = importance(training["importance"], meanings)
        shown.append(Plot("size-importance", label, figure))
    return shown


def side_by_side(metrics: Mapping[str, Any]) -> dict[str, dict[str, Mapping[str, float]]]:
    """Errors by predictor and domain, the shipped one first."""
    there = {
        domain: metrics[domain] for domain in SIZE_DOMAINS if "other" in metrics.get(domain, {})
    }
    if not there:
        return {}
    found: dict[str, dict[str, Mapping[str, float]]] = {SHIPPED: dict(there)}
    for key, label in RIVALS.items():
        found[label] = {d: one["other"][key] for d, one in there.items() if key in one["other"]}
    return {label: errors for label, errors in found.items() if errors}


def better(metrics: Mapping[str, Any]) -> str:
    """Which other predictors are better than the shipped one, and whether that is sure."""
    told, sure = [], []
    for domain, where in (("simulation", "in simulation"), ("robot", "on the robot")):
        shipped = metrics.get(domain) or {}
        for key, label in RIVALS.items():
            one = (shipped.get("other") or {}).get(key)
            if one and one["gain"] < 0.0:
                mae, than = fixed(one["mae"], 2), fixed(shipped["mae"], 2)
                told.append(f"{label} {where} ({mae} for {than} mm)")
                sure += [f"{label} {where}"] if one["gain_high"] < 0.0 else []
    if not told:
        return "None of the others is better on these tests."
    held = f"sure only of {', '.join(sure)}" if sure else "of none of them sure"
    return (
        f"Better on these tests: {', '.join(told)}. By the 95 % interval of the difference on "
        f"the same wraps that is {held}."
    )


def unlisted(robot: Mapping[str, Any]) -> str:
    """The error on the robot's wraps of diameters that the training does not list."""
    one = robot.get("unlisted")
    if not one:
        return ""
    count, every = fixed(one["samples"], 0), fixed(robot["samples"], 0)
    span = f"{fixed(one['mae_low'], 2)} to {fixed(one['mae_high'], 2)}"
    return (
        f"{count} of the robot's {every} wraps have diameters that the training does not list: "
        f"on these the MAE is {fixed(one['mae'], 2)} mm ({span}), on all {every} "
        f"{fixed(robot['mae'], 2)} mm."
    )


def choice(tried: Sequence[Mapping[str, float]]) -> str:
    """What the training chose of the stack's numbers, and what that is worth to its own error."""
    if not tried:
        return ""
    best = min(tried, key=lambda one: one["mae"])
    worst = max(one["mae"] for one in tried)
    about = SizeSettings.parameters()
    numbers = " and ".join(f"{about[n].meaning} {v:g}" for n, v in best.items() if n != "mae")
    return (
        f"Of {len(tried)} combinations of its numbers the training's out-of-fold error chose "
        f"{numbers}: {fixed(best['mae'], 2)} mm, where the worst has {fixed(worst, 2)}. "
        "No tested wrap had a say in it."
    )


def predictors(errors: Mapping[str, Mapping[str, Mapping[str, float]]]) -> go.Figure:
    """MAE of each predictor with its 95 % interval, by domain; a logarithmic axis.

    errors  name of the predictor -> domain -> mae, mae_low, mae_high [mm]
    """
    figure = bars(110 + 36 * len(errors), scattermode="group", scattergap=0.6)
    for domain, (name, colour, symbol) in SIZE_DOMAINS.items():
        kept = {label: one[domain] for label, one in errors.items() if domain in one}
        figure.add_scatter(
            x=[one["mae"] for one in kept.values()],
            y=list(kept),
            mode="markers",
            name=name,
            marker={"color": colour, "symbol": symbol, "size": 9},
            error_x=_interval(list(kept.values()), colour),
            hovertemplate="%{x:.2f} mm<extra>%{y}, " + name + "</extra>",
        )
    figure.update_xaxes(title_text=MAE, type="log", tickvals=TICKS, rangemode="normal")
    return figure


def learning_curve(curve: Mapping[str, Mapping[str, Mapping[str, float]]]) -> go.Figure:
    """MAE over the number of training samples, with its 95 % interval over the wraps tested.

    curve  number of samples -> domain -> mae, mae_low, mae_high [mm]
    """
    figure = blank(360)
    counts = [int(count) for count in curve]
    for domain, (name, colour, symbol) in SIZE_DOMAINS.items():
        steps = [one[domain] for one in curve.values()]
        figure.add_scatter(
            x=counts,
            y=[step["mae"] for step in steps],
            mode="lines+markers",
            name=name,
            line={"color": colour, "width": 1.8},
            marker={"color": colour, "symbol": symbol, "size": 8},
            error_y=_interval(steps, colour),
            hovertemplate="%{x} wraps: %{y:.2f} mm<extra>" + name + "</extra>",
        )
    figure.update_xaxes(title_text="wraps learned from", type="log", tickvals=counts)
    figure.update_yaxes(title_text=MAE, rangemode="tozero")
    return figure


def importance(grown: Mapping[str, float], meanings: Mapping[str, str]) -> go.Figure:
    """By how much the MAE in simulation grows when one feature is shuffled [mm], most first."""
    figure = bars(90 + 26 * len(grown))
    figure.add_bar(
        x=list(grown.values()),
        y=[name.replace("_", " ") for name in grown],
        orientation="h",
        marker={"color": NAMED},
        customdata=[meanings.get(name, "") for name in grown],
        hovertemplate="%{x:.1f} mm<br>%{customdata}<extra>%{y}</extra>",
        showlegend=False,
    )
    figure.update_xaxes(title_text="growth of the mean absolute error in simulation [mm]")
    return figure


def _interval(errors: Sequence[Mapping[str, float]], colour: str) -> dict[str, Any]:
    return {
        "type": "data",
        "array": [one["mae_high"] - one["mae"] for one in errors],
        "arrayminus": [one["mae"] - one["mae_low"] for one in errors],
        "color": colour,
        "thickness": 1.2,
        "width": 3,
    }
