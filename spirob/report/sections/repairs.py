"""What was repaired or left out of the logs, and which effects this rig cannot show."""

from collections.abc import Sequence
from typing import Any

from spirob.report.data import ReportData
from spirob.report.sections import Section


class Repairs(Section):
    """Everything that was changed before the diagnosis saw it."""

    order = 60
    title = "Data and limits"
    template = "rig_repairs.html.j2"
    pages = ("rig",)

    def get_context(self, data: ReportData) -> dict[str, Any]:
        return {
            "repairs": each_once(data.diagnosis["repairs"]),
            "excluded": {
                name.replace("_", " "): reason
                for name, reason in data.diagnosis["excluded"].items()
            },
        }


def each_once(notes: Sequence[str]) -> list[str]:
    """Notes in their order; what is said of several logs, `log: note`, once with their names."""
    logs: dict[tuple[str, str], list[str]] = {}
    for note in notes:
        log, colon, text = note.partition(": ")
        logs.setdefault((colon, text or log), []).append(log)
    return [
        ", ".join(names) + colon + text if colon else text for (colon, text), names in logs.items()
    ]
