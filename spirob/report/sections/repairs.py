"""What was repaired or left out of the logs, and which effects this rig cannot show."""

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
            "repairs": data.diagnosis["repairs"],
            "excluded": {
                name.replace("_", " "): reason
                for name, reason in data.diagnosis["excluded"].items()
            },
        }
