"""What the report is made of: the files, who writes them, what they must hold.

Everything inside is SI; the sections change to mm and ms.  A file that must exist and does not is
an error that names the stage writing it; a file that may be absent leaves a sentence in `absent`,
which its section prints in place of the numbers.

How the loop kept its deadlines comes from what the logs say of it.
"""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import yaml

from spirob.diagnosis import schema
from spirob.effects import Effect, all_effects
from spirob.errors import DataError, MissingChannel, MissingLog
from spirob.logs.messages import LOOP
from spirob.logs.trace import KEY
from spirob.plant import Rig
from spirob.report.arm import NoClip, film
from spirob.report.provenance import Provenance, collect
from spirob.unit_table import Geometry


@dataclass(frozen=True)
class Source:
    """A file: its path under the root, the stage that writes it, the keys or columns it must hold.

    why  for a file that may be absent: what its absence means; None where it is required
    instead  path of a lesser file that is read where this one is absent
    reader   of the file; None: the one of its suffix
    """

    path: str
    stage: str
    keys: tuple[str, ...] = ()
    why: str | None = None
    instead: str = ""
    reader: Callable[[Path], Any] | None = None


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
        reader=schema.read,
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
    "composed": Source(
        "data/diagnosis/composed.parquet",
        "decide",
        ("effect", "position", "velocity", "time", "effort", "shown", "law", "band", "axis"),
        "no law was composed",
    ),
    "posture": Source(
        "data/truth/posture",
        "collect",
        ("trial", "time", "q0"),
        "the robot's own shape is not known: its drives do not see it",
    ),
    "size_metrics": Source(
        "reports/metrics/size.json", "evaluate", (), "object size was not estimated in this run"
    ),
    "predictions": Source(
        "data/features/predictions.parquet",
        "evaluate",
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
        "reports/metrics/score.json", "evaluate", (), "the truth of this machine was not opened"
    ),
}


@dataclass(frozen=True)
class ReportData:
    """Everything the sections read; fields are named as in `SOURCES`.

    config      the resolved configuration as its YAML text
    metrics     stage -> its metrics file
    clip        rendered video, an animated WebP; `with_clip` adds it
    loops       trial -> how the loop kept its deadlines, where the robot was in real time
    absent      name of an optional source -> sentence saying why it is not here
    library     laws by name; of a rig those that its model holds
    """

    config: str
    identified: dict[str, Any]
    compare: dict[str, Any]
    diagnosis: dict[str, Any]
    overlay: pd.DataFrame
    metrics: dict[str, dict[str, Any]]
    provenance: Provenance
    motion: pd.DataFrame | None = None
    posture: pd.DataFrame | None = None
    combinations: pd.DataFrame | None = None
    laws: pd.DataFrame | None = None
    composed: pd.DataFrame | None = None
    predictions: pd.DataFrame | None = None
    experiments: dict[str, Any] | None = None
    contacts: dict[str, Any] | None = None
    passive: dict[str, Any] | None = None
    transfer: dict[str, Any] | None = None
    sweep: dict[str, Any] | None = None
    trial: dict[str, Any] | None = None
    score: dict[str, Any] | None = None
    clip: bytes | None = None
    loops: dict[str, dict[str, Any]] = field(default_factory=dict)
    absent: dict[str, str] = field(default_factory=dict)
    library: Mapping[str, type[Effect]] = field(default_factory=all_effects)

    @property
    def geometry(self) -> Geometry:
        """What the arm is, by the configuration's rig."""
        rig = (yaml.safe_load(self.config) or {}).get("rig", {})
        return Rig.from_mapping({k: v for k, v in rig.items() if k == "geometry"}).geometry


def load(root: Path | str) -> ReportData:
    """Read all sources under `root`.

    Raises MissingLog for an absent required file, DataError or MissingChannel for a broken one.
    """
    root = Path(root)
    found: dict[str, Any] = {}
    absent: dict[str, str] = {}
    for name, declared in SOURCES.items():
        source = _present(root, declared)
        if _is_there(root / source.path):
            found[name] = _read(root / source.path, source)
        elif source.why is None:
            raise MissingLog(f"{source.path} is missing; the stage '{source.stage}' writes it")
        else:
            absent[name] = f"{source.why[0].upper()}{source.why[1:]} ({source.path} is absent)."
    metrics = {
        name.removesuffix("_metrics"): found.pop(name)
        for name in list(found)
        if name.endswith("_metrics")
    }
    read = [_present(root, source).path for n, source in SOURCES.items() if n not in absent]
    provenance = collect(root, read, found["config"])
    loops = read_loops(root / "data/traces")
    return ReportData(metrics=metrics, provenance=provenance, loops=loops, absent=absent, **found)


def with_clip(data: ReportData) -> ReportData:
    """The same with a rendered video, or with the reason why there is none."""
    if data.motion is None:
        return data
    try:
        return replace(data, clip=film(data.motion, data.geometry))
    except NoClip as reason:
        return replace(
            data, absent=data.absent | {"clip": f"There is no rendered video: {reason}."}
        )


def _present(root: Path, source: Source) -> Source:
    """The source, or what stands in for it where it is absent."""
    if source.instead and not _is_there(root / source.path) and _is_there(root / source.instead):
        return replace(source, path=source.instead)
    return source


def _is_there(path: Path) -> bool:
    return any(path.glob("*.parquet")) if path.is_dir() else path.exists()


def _read(path: Path, source: Source) -> Any:
    reader = source.reader or READERS[path.suffix]
    try:
        content = reader(path)
    except (OSError, ValueError, DataError) as error:
        raise DataError(
            f"{source.path} cannot be read ({error}); the stage '{source.stage}' writes it"
        ) from error
    for key in source.keys:
        if key not in content:
            raise MissingChannel(source.path, key, [str(k) for k in content])
    return content


def _read_tables(folder: Path) -> pd.DataFrame:
    """All tables of a folder, one after the other."""
    parts = [pd.read_parquet(path) for path in sorted(folder.glob("*.parquet"))]
    return pd.concat(parts, ignore_index=True)


READERS: dict[str, Callable[[Path], Any]] = {
    ".json": lambda path: json.loads(path.read_text(encoding="utf-8")),
    ".parquet": pd.read_parquet,
    ".yaml": lambda path: path.read_text(encoding="utf-8"),
    "": _read_tables,
}


FIGURES = ("cycles", "skipped", "lateness_p50_us", "lateness_p99_us", "lateness_max_us")


def read_loops(folder: Path) -> dict[str, dict[str, Any]]:
    """Trial -> figures [µs], `histogram` with its edges, and `priority`; none in simulated time.

    folder  of decoded traces; of each, only the description is read
    """
    found = {}
    for path in sorted(folder.glob("*.parquet")):
        try:
            meta = json.loads((pq.read_schema(path).metadata or {})[KEY])["meta"]
            found[path.stem] = _numbers(meta[LOOP])
        except (KeyError, ValueError, TypeError, OSError, pa.ArrowException):
            continue  # no trace of a robot in real time
    return found


def _numbers(loop: dict[str, str]) -> dict[str, Any]:
    figures = {name: float(loop[name]) for name in FIGURES}
    edges = [float(edge) for edge in loop["histogram_from_us"].split()]
    counts = [int(count) for count in loop["histogram"].split()]
    if len(edges) != len(counts):
        raise ValueError("a histogram needs as many edges as counts")
    return {**figures, "edges": edges, "counts": counts, "priority": str(loop["priority"])}
