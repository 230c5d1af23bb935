"""Where the page comes from, and how to make it again."""

from typing import Any

from spirob.report.data import ReportData
from spirob.report.sections import Section
from spirob.report.words import number


class ProvenanceSection(Section):
    """Commit, seed, versions, hashes, configuration, metrics and the command."""

    order = 90
    title = "Provenance"
    template = "provenance.html.j2"
    pages = ("arm", "rig")

    def get_context(self, data: ReportData) -> dict[str, Any]:
        found = data.provenance
        metrics = [pair for stage in data.metrics for pair in flat(data.metrics[stage], stage)]
        return {
            "found": found,
            "state": state(found.dirty),
            "config": data.config,
            "metrics": metrics,
        }


def state(dirty: bool | None) -> str:
    """What the dirty flag means, in words."""
    if dirty is None:
        return "not under version control"
    return "code or configuration changed since" if dirty else "clean"


def flat(node: Any, path: str) -> list[tuple[str, str]]:
    """A tree of metrics as lines of path and value."""
    if isinstance(node, dict):
        return [pair for key, value in node.items() for pair in flat(value, f"{path}.{key}")]
    if isinstance(node, float):
        return [(path, number(node, 4))]
    return [(path, str(node))]
