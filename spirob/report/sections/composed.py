"""A law composed for what no name explains in the arm's currents."""

from typing import Any

from spirob.report.data import ReportData
from spirob.report.rig.composed import RigComposed
from spirob.report.words import EFFORT


class Composed(RigComposed):
    """As of a rig, where the verdict is unknown."""

    nothing = (
        "No law was composed: it is asked for where something is missing that the library does not "
        "hold, and has to take what is left in trials that no fit saw."
    )

    def about(self, data: ReportData) -> dict[str, Any]:
        unit = data.diagnosis["unit"]
        return {"effort": EFFORT[unit], "unit": unit}

    def how(self, file: str) -> list[str]:
        return [f"spirob run 'plant.effects=[data/diagnosis/{file}]'", ""]
