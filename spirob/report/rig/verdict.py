"""The first screen: the verdict in a sentence, what it gains, and the ladder of errors."""

from typing import Any

from spirob.report.data import ReportData
from spirob.report.ladder import ladder_plot
from spirob.report.sections import Section
from spirob.report.sections.verdict import floor_sentence, gain_sentence, kind


class RigVerdict(Section):
    """Verdict of a rig's diagnosis; there is no arm to be shown."""

    order = 10
    title = "Verdict"
    template = "rig_verdict.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        diagnosis = data.diagnosis
        unit, rungs = diagnosis["unit"], diagnosis["ladder"]
        noise_floor = diagnosis.get("noise_floor")
        return {
            "kind": kind(diagnosis),
            "sentence": diagnosis["sentence"],
            "explanation": diagnosis["explanation"],
            "gain": gain_sentence(rungs, noise_floor, unit),
            "floor": floor_sentence(diagnosis),
            "ladder": ladder_plot(rungs, noise_floor, unit),
            "repairs": diagnosis["repairs"],
        }
