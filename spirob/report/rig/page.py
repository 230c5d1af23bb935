"""Puts a rig's diagnosis on one page: verdict first, then overlay, failure, ladder, repairs."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from spirob.logs.atomic import write_text
from spirob.report.builder import render
from spirob.report.data import ReportData
from spirob.report.provenance import collect
from spirob.report.rig.laws import RigLaws
from spirob.report.rig.motion import RigMotion
from spirob.report.rig.overlay import RigOverlay
from spirob.report.rig.repairs import Repairs
from spirob.report.rig.verdict import RigVerdict
from spirob.report.sections.failure import Failure
from spirob.report.sections.ladder import Ladder
from spirob.report.sections.library import Library
from spirob.report.sections.parameters import Parameters
from spirob.report.sections.provenance import ProvenanceSection

SECTIONS = (
    RigVerdict,
    RigOverlay,
    RigMotion,
    Failure,
    Ladder,
    RigLaws,
    Parameters,
    Repairs,
    Library,
    ProvenanceSection,
)


def build_rig_page(
    document: dict[str, Any],
    overlay: pd.DataFrame,
    parameters: dict[str, Any],
    identifiability: str,
    rig_file: Path,
    logs: Sequence[Path],
    command: str,
    out: Path,
    laws: pd.DataFrame | None = None,
    motion: pd.DataFrame | None = None,
) -> Path:
    """Write the page, whole or not at all.

    document    what diagnosis.json holds;  parameters  fitted numbers of the bare model
    overlay     per sample: trial, role, time, measured, base, named, in the unit of the effort
    laws        per held-out sample: effect, time, position, velocity, effort, shown, law, in SI
    motion      per sample: trial, role, time, position and speed as measured and as predicted, SI
    command     that makes the page again
    """
    config = rig_file.read_text(encoding="utf-8")
    files = [rig_file.resolve(), *(log.resolve() for log in logs)]
    found = collect(Path.cwd(), [str(f) for f in files], config)
    # names, not places: where a log lies on somebody's disk is no provenance
    hashes = {Path(path).name: digits for path, digits in found.hashes.items()}
    provenance = type(found)(
        commit=found.commit,
        dirty=found.dirty,
        changed=found.changed,
        seed="0",
        command=command,
        versions=found.versions,
        hashes=hashes,
    )
    data = ReportData(
        config=config,
        identified={"parameters": parameters, "identifiability": identifiability},
        compare={},
        diagnosis=_with_heldout(document),
        overlay=overlay,
        laws=laws,
        motion=motion,
        metrics={},
        provenance=provenance,
    )
    write_text(out, render(data, [section() for section in SECTIONS]))
    return out


def _with_heldout(document: dict[str, Any]) -> dict[str, Any]:
    """The page's sections call the test logs held out."""
    return {**document, "ladder": [_rung(rung) for rung in document["ladder"]]}


def _rung(rung: dict[str, Any]) -> dict[str, Any]:
    intervals = rung["interval"]
    held = {"heldout": rung["test"], "interval": {**intervals, "heldout": intervals["test"]}}
    return {**rung, **held}
