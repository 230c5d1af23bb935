"""Where the base model fails: which moments hold more error than their share of time."""

from typing import Any

from spirob.report import figures
from spirob.report.data import ReportData
from spirob.report.sections import Section
from spirob.report.words import column, fixed, is_number, number, percent


class Failure(Section):
    """The residual atlas: what holds the error, worst first, and what it follows."""

    order = 30
    title = "Where it fails"
    template = "failure.html.j2"
    pages = ("arm", "rig")

    def get_context(self, data: ReportData) -> dict[str, Any]:
        regimes = sorted(data.diagnosis["atlas"], key=lambda r: -(r["share_of_error"] or 0))
        plot = None
        if regimes:
            plot = figures.Plot(
                "atlas",
                "Share of squared error beside share of time for the regimes that are worst",
                figures.atlas(dense(regimes)),
            )
        waves = data.diagnosis.get("atlas_orders") or []
        return {
            "sentences": data.diagnosis.get("atlas_sentences", []),
            "plot": plot,
            "unit": data.diagnosis["unit"],
            "groups": groups(regimes),
            "depends": data.diagnosis.get("depends", {}).get("sentence", ""),
            "orders": [_wave(w) for w in waves],
            "ordered": "atlas_orders" in data.diagnosis,
            "lateness": lateness_sentence(data.diagnosis.get("atlas_lateness") or {}),
        }


def dense(regimes: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Those that hold more error than their time explains; all where none does."""
    found = [r for r in regimes if (r["share_of_error"] or 0) > (r["share_of_time"] or 0)]
    return found or regimes


def groups(regimes: list[dict[str, Any]]) -> list[tuple[str, list[dict[str, str]]]]:
    """Rows by what regimes are about; the kind that holds the worst regime first."""
    rows = table(regimes)
    kinds = dict.fromkeys(r.get("kind", "") for r in regimes)
    return [
        (kind, [row for row, r in zip(rows, regimes, strict=True) if r.get("kind", "") == kind])
        for kind in kinds
    ]


def lateness_sentence(found: dict[str, Any]) -> str:
    """What a delay and the command's rate would explain; empty where it is not known."""
    if not is_number(found.get("delay_share")):
        return ""
    said = (
        f"A delay of the measurement by {fixed(found['delay_ms'], 2)} ms would explain "
        f"{percent(found['delay_share'])} of the squared error"
    )
    command = found.get("command_share")
    if is_number(command):
        said += f"; the command’s rate explains {percent(command)}"
    return said + "."


def _wave(wave: dict[str, Any]) -> dict[str, str]:
    turns = {"output": "gear’s output", "stroke": "whole stroke"}.get(wave["of"], wave["of"])
    share = percent(wave["share_of_error"])
    return {"turns": turns, "order": number(wave["order"]), "error": share}


def table(regimes: list[dict[str, Any]]) -> list[dict[str, str]]:
    """The same numbers as the bars, with bias, RMSE and how dense the error is."""
    biases = column([r.get("bias") for r in regimes])
    errors = column([r.get("rmse") for r in regimes])
    return [
        {
            "regime": regime["regime"],
            "error": percent(regime["share_of_error"]),
            "time": percent(regime["share_of_time"]),
            "density": _density(regime),
            "bias": bias,
            "rmse": error,
        }
        for regime, bias, error in zip(regimes, biases, errors, strict=True)
    ]


def _density(regime: dict[str, Any]) -> str:
    error, time = regime["share_of_error"], regime["share_of_time"]
    if not (is_number(error) and is_number(time) and time > 0):
        return "–"
    return f"{error / time:.1f}×"
