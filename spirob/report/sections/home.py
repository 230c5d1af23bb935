"""What of this diagnosis may be taken home, and how: the corrected model for other programs."""

from typing import Any

from spirob.report.data import ReportData
from spirob.report.sections import Section

TARGETS = (  # target, for whom, what it holds
    ("mujoco", "plain MuJoCo", "every effect, stepped beside mj_step by a small Python module"),
    (
        "mjcf",
        "MuJoCo without Python",
        "what its attributes and actuators can say; the file lists the rest with its size",
    ),
    ("c", "a drive or a controller", "the feed-forward and the friction terms, in C99"),
    ("bam", "BAM", "friction of a servo, models M1, M2 and M5"),
    (
        "table",
        "a paper, or randomisation",
        "numbers with intervals, covariance, and a script that draws machines",
    ),
)
GOES = {
    "named": "The fitted numbers and what is named",
    "undecided": "The fitted numbers alone, as what is missing is not decided",
    "nothing_missing": "The fitted numbers, in which nothing is missing",
    "unknown": "The fitted numbers alone, as what is missing has no name",
}


class Home(Section):
    """The model that stands, and the command for each program that can run it."""

    order = 82
    title = "Take it home"
    template = "home.html.j2"
    pages = ("arm", "rig")

    def get_context(self, data: ReportData) -> dict[str, Any]:
        told = data.diagnosis
        named = told["effects"] if told["verdict"] == "named" else []
        return {
            "senseless": bool(told.get("doubts")),
            "goes": GOES.get(told["verdict"], GOES["unknown"]),
            "named": [effect["title"] for effect in named],
            "where": "DIR/diagnosis.json" if "rig" in told else "data/diagnosis/diagnosis.json",
            "targets": TARGETS,
        }
