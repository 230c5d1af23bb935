"""The files that the report is made of: where they lie, who writes them, what they must hold."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Source:
    """A file: its path under the root, the stage that writes it, the keys or columns it must hold.

    why  for a file that may be absent: what its absence means; None where it is required
    instead  path of a lesser file that is read where this one is absent
    """

    path: str
    stage: str
    keys: tuple[str, ...] = ()
    why: str | None = None
    instead: str = ""


CHANNELS = ("current", "displacement", "velocity")
OVERLAY_CHANNELS = tuple(
    f"{origin}_{channel}" for channel in CHANNELS for origin in ("measured", "base", "named")
)
SOURCES = {
    "config": Source("data/config/config.yaml", "config"),
    "identified": Source("data/identified/base.json", "identify", ("parameters",)),
    "compare": Source("data/compare/compare.json", "compare", ("trials",)),
    "diagnosis": Source(
        "data/diagnosis/diagnosis.json",
        "decide",
        ("verdict", "sentence", "effects", "candidates", "ladder", "atlas", "unit"),
    ),
    "overlay": Source(
        "data/diagnosis/overlay.parquet",
        "decide",
        ("trial", "role", "motor", "time", *OVERLAY_CHANNELS),
    ),
    "identify_metrics": Source("reports/metrics/identify.json", "identify"),
    "compare_metrics": Source("reports/metrics/compare.json", "compare"),
    "diagnose_metrics": Source("reports/metrics/diagnose.json", "decide"),
    "motion": Source(
        "data/diagnosis/motion.parquet",
        "decide",
        ("trial", "time", "q0"),
        "the model of this rig has no arm, or its motion was not kept",
    ),
    "combinations": Source(
        "data/diagnosis/combinations.parquet",
        "decide",
        ("effects", "trial", "role", "motor", "time", "how", *CHANNELS),
        "no candidate was fitted, or its response was not kept",
    ),
    "laws": Source(
        "data/diagnosis/laws.parquet",
        "decide",
        ("effect", "trial", "role", "motor", "time", "with_current", "without_current"),
        "no candidate was fitted, so there is no law to draw",
    ),
    "posture": Source(
        "data/truth/posture",
        "collect",
        ("trial", "time", "q0"),
        "the robot's own shape is not known: its drives do not see it",
    ),
    "size_metrics": Source(
        "reports/metrics/size.json", "size", (), "object size was not estimated in this run"
    ),
    "predictions": Source(
        "data/features/predictions.parquet",
        "size",
        ("domain", "true_mm", "predicted_mm"),
        "object size was not estimated in this run",
    ),
    "experiments": Source(
        "data/experiments/experiments.json",
        "experiments",
        (),
        "the paper's experiments were not played in this run",
    ),
    "contacts": Source(
        "reports/metrics/contacts.json",
        "contacts",
        ("current", "filtered"),
        "the contact detector was not tested here",
    ),
    "passive": Source(
        "reports/metrics/passive.json",
        "passive",
        ("model",),
        "pushes felt by the current were not played in this run",
    ),
    "transfer": Source(
        "data/transfer/transfer.json",
        "transfer",
        ("robot",),
        "size was not learned from the other models in this run",
    ),
    "sweep": Source("data/sweep/table.json", "sweep", ("columns", "rows"), "no sweep was run here"),
    "trial": Source(
        "reports/metrics/trial_full.json",
        "trial",
        (),
        "no trial was run here",
        instead="reports/metrics/trial.json",
    ),
    "score": Source(
        "reports/metrics/score.json", "score", (), "the truth of this machine was not opened"
    ),
}
