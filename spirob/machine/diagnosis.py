"""From logs to a verdict: a plain rig, or our arm logged by somebody else.

Logs are read (`spirob.logs.readers`) and repaired (`recording`); `axis` fits, searches and judges a
plain rig, `arm.diagnosis` our arm.  `Diagnosis.save` in `result` writes, `spirob.report`
draws.  Numbers that fail where nobody foresaw it are told in a sentence.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import yaml

from spirob import plain_yaml
from spirob.diagnosis.criteria import Criteria, Settings
from spirob.diagnosis.schema import checked
from spirob.effects import Effect
from spirob.errors import ConfigError, DataError, NothingLeft, SimulationError
from spirob.files import inside, named
from spirob.logs.readers import Table, read_table
from spirob.logs.readers.columns import from_frame
from spirob.machine.arm.description import ArmFile
from spirob.machine.axis import diagnose_recordings
from spirob.machine.description.rig import RigFile
from spirob.machine.document import plain
from spirob.machine.loading import chosen, described, files, load_rig
from spirob.machine.page_tables import laws
from spirob.machine.recordings.recording import of_table
from spirob.machine.recordings.saturation import ends_of_logs
from spirob.machine.recordings.selection import each_once, filtered_alike
from spirob.machine.result import Diagnosis, Sources

FAIL = (np.linalg.LinAlgError, ArithmeticError, MemoryError, SimulationError, ValueError)
# what SciPy and scikit-learn say of numbers that they cannot use; any other ValueError is a bug
SAID = re.compile(r"finite|\bnan|\binf|too large|bound|infeasible|converge", re.IGNORECASE)


class Heard:
    """A caller's own function of progress, and what it raised: no failure of our numbers."""

    def __init__(self, function: Callable[[str], None]):
        self._function = function
        self.raised: Exception | None = None

    def __call__(self, text: str) -> None:
        """Tell it a step."""
        try:
            self._function(text)
        except Exception as error:
            self.raised = error
            raise


@contextmanager
def failures_told(who: str, heard: Heard | None = None) -> Iterator[None]:
    """Inside, a numerical failure becomes a DataError that names `who`; none that was `heard`."""
    try:
        yield
    except FAIL as error:
        theirs = heard is not None and error is heard.raised
        if theirs or not _of_numbers(error):
            raise
        raise DataError(_sentence(who, error)) from error


def _of_numbers(error: Exception) -> bool:
    """Whether an error says that numbers fail; a ValueError may be a bug as well."""
    surely = isinstance(error, np.linalg.LinAlgError) or not isinstance(error, ValueError)
    return surely or bool(SAID.search(str(error)))


def _sentence(who: str, error: Exception) -> str:
    said = " ".join(str(error).split())[:200].rstrip(".") or type(error).__name__
    return (
        f"{who}: its numbers cannot be computed with ({said}); look for a factor, a bound or a "
        "value in the logs that is many times too large or too small"
    )


Log = Path | str | pd.DataFrame


def diagnose(
    rig: Path | str | Mapping[str, Any],
    train: Sequence[Log],
    test: Sequence[Log] = (),
    settings: Criteria | None = None,
    progress: Callable[[str], None] = lambda text: None,
    command: str = "",
    effects: Sequence[Path | str] = (),
) -> Diagnosis:
    """Name what the model of a machine misses, from its description and logs.

    rig      a description's file, or what it would hold; paths in it count from the file's folder,
             else from the working folder
    train    logs to fit: files, or tables with the columns that the description names
    test     logs held out; without one the end of each training log is kept aside
    settings how the search of a plain rig decides, in place of the description's `criteria`
    command  that repeats this, for the page
    effects  further ones that the model holds, names or files of one's own from anywhere; those
             that a description names lie beside or below it

    A table is called by its `attrs["name"]`, else by its place, as in `train[0]`.  Raises
    ConfigError, DataError or EffectError, in a sentence, where something given cannot be used;
    what `progress` raises comes out as it is.
    """
    if isinstance(rig, Mapping):
        told, folder, who = described(rig, "rig"), Path(), "rig"
    elif isinstance(rig, str | Path):
        (told, folder), who = load_rig(rig), str(rig)
    else:
        raise ConfigError(f"rig: a file or a mapping of keys, got {type(rig).__name__}")
    if settings is not None and not isinstance(settings, Criteria):
        raise ConfigError(f"settings: Criteria, got {type(settings).__name__}")
    if isinstance(told, ArmFile):
        told = told.beside(folder)
    names = files(told.effects, folder, effects)
    ran = [f"{name}: was run, as an effect of your own." for name in names if name.endswith(".py")]
    progress = Heard(progress)
    with failures_told(who, progress):
        own = chosen(names)
        (fitted, empty), (held, more) = (
            _read(told, folder, logs, role) for role, logs in (("train", train), ("test", test))
        )
        if not fitted:
            raise DataError("; ".join(empty) or "a diagnosis needs at least one training log")
        each_once([(t.name, t.columns) for t in (*fitted, *held)], told.moving_columns())
        if isinstance(told, ArmFile):
            found = _arm(told, fitted, held, progress, own)
        else:

            def found_of(fitted: Sequence[Table], held: Sequence[Table]) -> Diagnosis:
                ends = ends_of_logs(told, [*fitted, *held])
                trials = filtered_alike(
                    lambda log, cut: of_table(log, told, cut, ends), fitted, held
                )
                return diagnose_recordings(told, folder, *trials, settings, progress, own)

            found = _of_the_others(found_of, fitted, held, progress)
    found.document["repairs"][:0] = [*ran, *(f"{t}; the log is left out." for t in empty + more)]
    paths = [Path(log) for log in (*train, *test) if not isinstance(log, pd.DataFrame)]
    sources = _sources(rig, paths, command)
    return replace(found, sources=sources)


def _read(
    rig: RigFile | ArmFile, folder: Path, logs: Sequence[Log], role: str
) -> tuple[list[Table], list[str]]:
    """The logs as tables, and what is said of those without rows.

    A frame is called by its own name, or by its place.
    """
    if isinstance(logs, Path | str | pd.DataFrame):
        raise ConfigError(f"{role}: a list of logs, got a single one")
    if not isinstance(logs, Sequence):
        raise ConfigError(f"{role}: a list of logs, got {type(logs).__name__}")
    dbc = None if rig.dbc is None else inside(rig.dbc, folder, "dbc")
    found, empty = [], []
    for k, log in enumerate(logs):
        if isinstance(log, pd.DataFrame):
            found.append(from_frame(log, str(log.attrs.get("name") or f"{role}[{k}]")))
            continue
        if not isinstance(log, str | Path):
            raise ConfigError(f"{role}[{k}]: a file or a DataFrame, got {type(log).__name__}")
        try:
            found.append(read_table(named(log), rig.columns(), dbc))
        except NothingLeft as error:
            empty.append(str(error))
    return found, empty


def _of_the_others(
    found_of: Callable[[Sequence[Table], Sequence[Table]], Diagnosis],
    train: Sequence[Table],
    test: Sequence[Table],
    progress: Callable[[str], None],
) -> Diagnosis:
    """What logs say; of the others, where fewer than these fit no other."""
    found = found_of(train, test)
    odd, names = found.strange, ", ".join(found.strange)
    fitted, held = ([log for log in logs if log.name not in odd] for logs in (train, test))
    if not odd or 2 * len(odd) >= len(train) + len(test) or not fitted or (test and not held):
        return found
    progress(f"once more, without {names}")
    again = found_of(fitted, held)
    if again.document["doubts"]:
        return found
    said, told = " ".join(found.document["doubts"]), again.document
    fit = "fits" if len(odd) == 1 else "fit"
    told["sentence"] = f"Without {names}, which {fit} no other log: {told['sentence']}"
    told["repairs"][:0] = [f"{said} What is said is of the other logs."]
    return again


def _sources(rig: Path | str | Mapping[str, Any], logs: Sequence[Path], command: str) -> Sources:
    if isinstance(rig, Mapping):
        return Sources(yaml.safe_dump(plain(dict(rig)), allow_unicode=True), tuple(logs), command)
    return Sources(plain_yaml.text(Path(rig).read_bytes()), (Path(rig), *logs), command)


def _arm(
    rig: ArmFile,
    train: Sequence[Table],
    test: Sequence[Table],
    progress: Callable[[str], None],
    own: Sequence[type[Effect]],
) -> Diagnosis:
    """Diagnose our arm from logs of somebody else."""
    from spirob.machine.arm import diagnosis as arm
    from spirob.machine.arm.replay import table_of
    from spirob.machine.description.model_file import unheard

    settings = Settings(**asdict(rig.criteria), intervals=False, always=False)
    trials, said = arm.read(rig, train, test)
    with unheard():
        found = arm.searched(rig, trials, settings, progress, own=own, said=said)
    last, heldout = found.ended.found.chosen, found.models.heldout
    return Diagnosis(
        checked(arm.written(rig, found, said)),
        arm.overlay(found),
        arm.parameters(found),
        "",
        laws(heldout, last.effects, last.fit.changes, "m"),
        heldout=table_of(heldout.trials),
    )
