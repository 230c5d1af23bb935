"""Puts a rig's diagnosis on one page, of the sections that say they stand there."""

from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol

import pandas as pd

from spirob.report import render
from spirob.report.data import ReportData
from spirob.report.provenance import collect
from spirob.report.sections import discover


class Shown(Protocol):
    """What the page needs of a diagnosis; `spirob.machine.result.Diagnosis` is one.

    document    what diagnosis.json holds;  parameters  fitted numbers of the bare model
    overlay     per sample: trial, role, time, measured, base, named, in the unit of the effort
    laws        per held-out sample: effect, time, position, velocity, effort, shown, law, in SI
    motion      per sample: trial, role, time, position and speed as measured and as predicted, SI
    composed    of a composed law as `laws`, with its `band`; None where there is none
    """

    @property
    def document(self) -> dict[str, Any]: ...
    @property
    def overlay(self) -> pd.DataFrame: ...
    @property
    def parameters(self) -> dict[str, Any]: ...
    @property
    def identifiability(self) -> str: ...
    @property
    def laws(self) -> pd.DataFrame: ...
    @property
    def motion(self) -> pd.DataFrame | None: ...
    @property
    def composed(self) -> pd.DataFrame | None: ...
    @property
    def sources(self) -> Any: ...


def build_rig_page(found: Shown) -> str:
    """The page as text."""
    sources = found.sources
    files = [str(file.resolve()) for file in sources.files]
    about = collect(Path.cwd(), files, sources.config)
    # names, not places: where a log lies on somebody's disk is no provenance
    hashes = {Path(path).name: digits for path, digits in about.hashes.items()}
    provenance = replace(about, seed="0", command=sources.command, overrides=(), hashes=hashes)
    data = ReportData(
        config=sources.config,
        identified={"parameters": found.parameters, "identifiability": found.identifiability},
        compare={},
        diagnosis=_with_heldout(found.document),
        overlay=found.overlay,
        laws=found.laws,
        motion=found.motion,
        composed=found.composed,
        metrics={},
        provenance=provenance,
    )
    return render(data, discover("rig"))


def _with_heldout(document: dict[str, Any]) -> dict[str, Any]:
    """The page's sections call the test logs held out."""
    return {**document, "ladder": [_rung(rung) for rung in document["ladder"]]}


def _rung(rung: dict[str, Any]) -> dict[str, Any]:
    intervals = rung["interval"]
    held = {"heldout": rung["test"], "interval": {**intervals, "heldout": intervals["test"]}}
    return {**rung, **held}
