"""The whole way from files to a verdict: a plain rig, or our arm logged by somebody else."""

from collections.abc import Callable, Sequence
from pathlib import Path

from spirob.errors import ConfigError
from spirob.machine.arm.description import ArmFile
from spirob.machine.axis import Diagnosis, diagnose_recordings
from spirob.machine.loading import load_rig
from spirob.machine.recording import read_trial
from spirob.machine.shown import laws
from spirob.machine.worth import Settings


def diagnose(
    rig_file: Path | str,
    train: Sequence[Path | str],
    test: Sequence[Path | str],
    settings: Settings | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> Diagnosis:
    """Diagnose a machine from its description and logs.

    Without a held-out log the last quarter of the training logs is kept aside.  Raises ConfigError
    or DataError, in a sentence, where the description or a log cannot be used.
    """
    rig, folder = load_rig(rig_file)
    _each_once(train, test)
    if isinstance(rig, ArmFile):
        return _arm(rig, train, test, progress)
    progress(f"reading {len(train) + len(test)} logs")
    first = [read_trial(path, rig) for path in train]
    cutoff = min(r.cutoff for r in first) if rig.filter.cutoff is None else None
    trials = [
        r if cutoff in (None, r.cutoff) else read_trial(path, rig, cutoff)
        for r, path in zip(first, train, strict=True)
    ]
    held = [read_trial(path, rig, cutoff) for path in test]
    return diagnose_recordings(rig, folder, trials, held, settings, progress)


def _each_once(train: Sequence[Path | str], test: Sequence[Path | str]) -> None:
    """Raise where a log is given twice: a held-out log that was fitted vetoes nothing."""
    seen: set[Path] = set()
    for log in (*train, *test):
        path = Path(log).resolve()
        if path in seen:
            raise ConfigError(f"{log}: given twice; a log is fitted or held out, once")
        seen.add(path)


def _arm(
    rig: ArmFile,
    train: Sequence[Path | str],
    test: Sequence[Path | str],
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
