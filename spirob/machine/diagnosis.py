"""The whole way from files to a verdict: a plain rig, or our arm logged by somebody else."""

from collections.abc import Callable, Sequence
from pathlib import Path

from spirob.diagnose.rungs import Settings as ArmSettings
from spirob.effects import Effect
from spirob.given_file import checked
from spirob.machine.arm import diagnosis as arm
from spirob.machine.arm.description import ArmFile
from spirob.machine.arm.page import overlay, parameters
from spirob.machine.axis import Diagnosis, diagnose_recordings
from spirob.machine.given_twice import each_once
from spirob.machine.loading import load_rig
from spirob.machine.numerical import failures_told
from spirob.machine.own_effects import chosen, files
from spirob.machine.reading import read_columns
from spirob.machine.recording import Recording, prepare
from spirob.machine.rig import RigFile
from spirob.machine.shown import laws
from spirob.machine.worth import Settings


def diagnose(
    rig_file: Path | str,
    train: Sequence[Path | str],
    test: Sequence[Path | str],
    settings: Settings | None = None,
    progress: Callable[[str], None] = lambda text: None,
    effects: Sequence[Path | str] = (),
) -> Diagnosis:
    """Diagnose a machine from its description and logs.

    effects  further ones that the model holds, names or files of one's own from anywhere; those
             that a description names lie beside or below it

    Without a held-out log the last quarter of the training logs is kept aside.  Raises ConfigError,
    DataError or EffectError, in a sentence, where something that is given cannot be used.
    """
    rig, folder = load_rig(rig_file)
    for log in (*train, *test):
        checked(log, "log")
    names = files(rig.effects, folder, effects)
    ran = [f"{name}: was run, as an effect of your own." for name in names if name.endswith(".py")]
    with failures_told(str(rig_file)):
        own = chosen(names)
        if isinstance(rig, ArmFile):
            found = _arm(rig, train, test, progress, own)
        else:
            trials, held = _recordings(rig, train, test)
            found = diagnose_recordings(rig, folder, trials, held, settings, progress, own)
    found.document["repairs"][:0] = ran
    return found


def _recordings(
    rig: RigFile, train: Sequence[Path | str], test: Sequence[Path | str]
) -> tuple[list[Recording], list[Recording]]:
    """The logs for training and those held out, filtered alike."""
    read = [(Path(log).name, *read_columns(log)) for log in (*train, *test)]
    columns = [rig.position.column, rig.effort.column]
    each_once([(str(log), r[1]) for log, r in zip((*train, *test), read, strict=True)], columns)
    cutoff = rig.filter.cutoff or min(prepare(n, c, rig).cutoff for n, c, _ in read[: len(train)])
    made = [prepare(name, columns, rig, said, cutoff) for name, columns, said in read]
    return made[: len(train)], made[len(train) :]


def _arm(
    rig: ArmFile,
    train: Sequence[Path | str],
    test: Sequence[Path | str],
    progress: Callable[[str], None],
    own: Sequence[type[Effect]],
) -> Diagnosis:
    """Diagnose our arm from logs of somebody else; its search has settings of its own."""
    settings = ArmSettings(intervals=False)
    logs = [(str(log), read_columns(log)[0]) for log in (*train, *test)]
    each_once(logs, [motor.position.column for motor in rig.motors().values()])
    trials, said = arm.read(rig, train, test)
    search, residuals = arm.searched(rig, trials, settings, progress, own=own)
    found = arm.written(rig, search, residuals, settings, said)
    last = search.rungs[-1]
    return Diagnosis(
        found,
        overlay(search, residuals, found["verdict"] == "named"),
        parameters(search, residuals["train"].table),
        "",
        laws(residuals["heldout"], last.effects, last.fit.changes, "m"),
    )
