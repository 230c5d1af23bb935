"""Where the base model fails: which moments hold more error than their share of time."""

from typing import Any

from spirob.report import figures, regime_figures
from spirob.report.data import ReportData
from spirob.report.numbers import column, is_number, percent
from spirob.report.sections.section import Section


class Failure(Section):
    """The residual atlas, worst regime first."""

    order = 30
    title = "Where it fails"
    template = "failure.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        regimes = sorted(data.diagnosis["atlas"], key=lambda r: -(r["share_of_error"] or 0))
        plot = None
        if regimes:
            plot = figures.Plot(
                "atlas",
                "Share of squared error beside share of time for each regime",
                regime_figures.atlas(regimes),
            )
        return {
            "sentences": data.diagnosis.get("atlas_sentences", []),
            "plot": plot,
            "unit": data.diagnosis["unit"],
            "rows": table(regimes),
        }


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
