"""The whole way from logs to a verdict: a plain rig, or our arm logged by somebody else."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from spirob.errors import ConfigError
from spirob.machine.arm.description import ArmFile
from spirob.machine.axis import diagnose_recordings
from spirob.machine.loading import load_rig, rig_from
from spirob.machine.recording import read_trial
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
    train, test = _named(train, "train"), _named(test, "test")
    _each_once([*train, *test])
    if isinstance(described, ArmFile):
        found = _arm(described, train, test, progress)
    else:
        found = _axis(described, folder, train, test, settings, progress)
    own = Path(rig) if isinstance(rig, Path | str) else None
    config = own.read_text(encoding="utf-8") if own else yaml.safe_dump(dict(rig))  # type: ignore[arg-type]
    files = [Path(log) for log in (*train, *test) if not isinstance(log, pd.DataFrame)]
    sources = Sources(config, (*([own] if own else []), *files), command)
    return replace(found, sources=sources)


def _named(logs: Sequence[Log], role: str) -> list[Log]:
    """The logs, tables among them with a name."""
    if isinstance(logs, Path | str | pd.DataFrame):
        raise ConfigError(f"{role}: a list of logs, got a single one")
    named: list[Log] = []
    for k, log in enumerate(logs):
        if isinstance(log, pd.DataFrame) and not log.attrs.get("name"):
            log = log.copy(deep=False)
            log.attrs["name"] = f"{role}[{k}]"
        named.append(log)
    return named


def _each_once(logs: Sequence[Log]) -> None:
    """Raise where a log is given twice: a held-out log that was fitted vetoes nothing."""
    seen: set[Path] = set()
    for log in logs:
        if isinstance(log, pd.DataFrame):
            continue
        path = Path(log).resolve()
        if path in seen:
            raise ConfigError(f"{log}: given twice; a log is fitted or held out, once")
        seen.add(path)


def _axis(
    rig: RigFile,
    folder: Path,
    train: Sequence[Log],
    test: Sequence[Log],
    settings: Settings | None,
    progress: Callable[[str], None],
) -> Diagnosis:
    progress(f"reading {len(train) + len(test)} logs")
    first = [read_trial(path, rig) for path in train]
    cutoff = min(r.cutoff for r in first) if rig.filter.cutoff is None else None
    trials = [read_trial(path, rig, cutoff) for path in train]
    held = [read_trial(path, rig, cutoff) for path in test]
    return diagnose_recordings(rig, folder, trials, held, settings, progress)


def _arm(
    rig: ArmFile,
    train: Sequence[Log],
    test: Sequence[Log],
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
