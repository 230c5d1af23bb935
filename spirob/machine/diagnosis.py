"""The whole way from logs to a verdict: a plain rig, or our arm logged by somebody else."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from spirob.logs.readers import Table, from_frame, read_table
from spirob.machine.alike import filtered_alike
from spirob.machine.arm.description import ArmFile
from spirob.machine.axis import diagnose_recordings
from spirob.machine.loading import load_rig, rig_from
from spirob.machine.recording import columns_of, of_table
from spirob.machine.result import Diagnosis, Sources
from spirob.machine.rig import RigFile
from spirob.machine.shown import laws
from spirob.machine.worth import Settings

Log = Path | str | pd.DataFrame


def diagnose(
    rig: Path | str | Mapping[str, Any],
    train: Sequence[Log],
    test: Sequence[Log] = (),
    settings: Settings | None = None,
    progress: Callable[[str], None] = lambda text: None,
    command: str = "",
) -> Diagnosis:
    """Name what the model of a machine misses, from its description and logs.

    rig      a description's file, or what it would hold; paths in it count from the file's folder,
             else from the working folder
    train    logs to fit: files, or tables with the columns that the description names
    test     logs held out; without one the end of each training log is kept aside
    command  that repeats this, for the page

    A table is called by its `attrs["name"]`, else by its place, as in `train[0]`.  Raises
    ConfigError or DataError, in a sentence, where the description or a log cannot be used.
    """
    if isinstance(rig, Mapping):
        described, folder = rig_from(rig, "rig"), Path()
    else:
        described, folder = load_rig(rig)
    columns = columns_of(described) if isinstance(described, RigFile) else described.columns()
    dbc = None if described.dbc is None else folder / described.dbc
    progress(f"reading {len(train) + len(test)} logs")
    fitted, held = (
        [_table(log, f"{role}[{k}]", columns, dbc) for k, log in enumerate(logs)]
        for role, logs in (("train", train), ("test", test))
    )
    if isinstance(described, ArmFile):
        found = _arm(described, fitted, held, progress)
    else:
        trials = filtered_alike(lambda log, cut: of_table(log, described, cut), fitted, held)
        found = diagnose_recordings(described, folder, *trials, settings, progress)
    files = [Path(log) for log in (*train, *test) if not isinstance(log, pd.DataFrame)]
    return replace(found, sources=_sources(rig, files, command))


def _sources(rig: Path | str | Mapping[str, Any], files: Sequence[Path], command: str) -> Sources:
    if isinstance(rig, Mapping):
        return Sources(yaml.safe_dump(dict(rig), allow_unicode=True), tuple(files), command)
    return Sources(Path(rig).read_text(encoding="utf-8"), (Path(rig), *files), command)


def _table(log: Log, place: str, wanted: Sequence[str], dbc: Path | None) -> Table:
    """A log as a table; a frame is called by its own name, or by its place."""
    if isinstance(log, pd.DataFrame):
        return from_frame(log, str(log.attrs.get("name") or place))
    return read_table(log, wanted, dbc)


def _arm(
    rig: ArmFile,
    train: Sequence[Table],
    test: Sequence[Table],
    progress: Callable[[str], None],
) -> Diagnosis:
    """Diagnose our arm from logs of somebody else; its search has settings of its own."""
    from spirob.diagnose.rungs import Settings as ArmSettings
    from spirob.machine.arm import diagnosis as arm
    from spirob.machine.arm.page import overlay, parameters

    settings = ArmSettings(intervals=False)
    trials, said = arm.read(rig, train, test)
    search, residuals = arm.searched(rig, trials, settings, progress)
    found = arm.written(rig, search, residuals, settings, said)
    last = search.rungs[-1]
    return Diagnosis(
        found,
        overlay(search, residuals, found["verdict"] == "named"),
        parameters(search, residuals["train"].table),
        "",
        laws(residuals["heldout"], last.effects, last.fit.changes, "m"),
    )
