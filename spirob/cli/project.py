"""The folder that the pipeline's commands work in; the choices in params.yaml, and the way back.

Whatever ends a run that does not end well (a refusal of any stage, a busy lock of DVC, Ctrl-C,
SIGTERM), choices and composed configuration come back as they were, each file in one go.  Choices
that somebody else has made meanwhile stay.

DVC rewrites its lock table and `dvc.lock` in place, so a SIGKILL in that very moment leaves a torn
file, and DVC then refuses to run.  Both only record what ran: without the table nothing is locked,
and without `dvc.lock` the results come back from the cache.
"""

import fcntl
import json
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from spirob.errors import ConfigError
from spirob.files import write_bytes, write_text

MARKS = ("dvc.yaml", "params.yaml", "pipeline")
CHOICES = re.compile(r"^overrides:.*(?:\n[ \t-].*)*\n?", re.MULTILINE)
OVERRIDE = re.compile(r"^(?:~[\w./@-]+|\+{0,2}[\w./@-]+=.*)$", re.DOTALL)


def find_project(given: str | None) -> Path:
    """The folder named, or the nearest one above the current that holds the pipeline.

    Raises ConfigError where there is none.
    """
    tried = [Path(given)] if given else [Path.cwd(), *Path.cwd().parents]
    for folder in tried:
        if all((folder / mark).exists() for mark in MARKS):
            return folder.resolve()
    where = f"'{given}'" if given else f"'{Path.cwd()}' and the folders above it"
    raise ConfigError(f"no pipeline in {where}: dvc.yaml, params.yaml and pipeline/ belong to it")


def spelt_out(project: Path, choices: Sequence[str]) -> list[str]:
    """The choices, with the name of presets as a choice of each: `short`, `identify=short` ..."""
    out: list[str] = []
    for choice in choices:
        found = sorted((project / "conf").glob(f"*/{choice}.yaml")) if choice.isidentifier() else []
        out += [f"{preset.parent.name}={choice}" for preset in found] or [choice]
    return out


def read_overrides(project: Path) -> list[str]:
    """The choices on top of the defaults, as params.yaml lists them."""
    import yaml

    try:
        content = yaml.safe_load((project / "params.yaml").read_text(encoding="utf-8")) or {}
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ConfigError(f"params.yaml is not YAML: {error}") from None
    found = content.get("overrides") if isinstance(content, dict) else None
    if found is not None and not isinstance(found, list):
        raise ConfigError("params.yaml: 'overrides' must be a list, e.g. ['rig=spirob']")
    return [str(item) for item in found or []]


def write_overrides(project: Path, overrides: Sequence[str]) -> None:
    """Put the choices into params.yaml and leave everything else in it as it is."""
    import yaml

    for item in overrides:
        if not OVERRIDE.match(item):
            raise ConfigError(
                f"'{item}' is no KEY=VALUE, such as robot.hidden.effect=cogging, and no preset, "
                "such as short"
            )
    path = project / "params.yaml"
    text = path.read_text(encoding="utf-8")
    listed = yaml.safe_dump(list(overrides), default_flow_style=True, width=10_000).strip()
    line = f"overrides: {listed}\n"
    if CHOICES.search(text):
        changed = CHOICES.sub(lambda _: line, text, count=1)
    else:
        changed = text + ("" if text.endswith("\n") or not text else "\n") + line
    if changed != text:
        write_text(path, changed)


PARAMS = "params.yaml"
LOCK = "dvc.lock"
BACK = "the choices are taken back: params.yaml and data/config are as before"
COMPOSED = Path("data/config")


class Kept:
    """Restores a project's choices and composed configuration on leaving, unless `done` is set.

    With the choices goes what `dvc.lock` says of the configuration that was composed by them, where
    no other stage has run.

    chosen  what the run puts into params.yaml; None where it leaves that file alone
    """

    def __init__(self, project: Path, chosen: Sequence[str] | None):
        self.done = False
        self._project = project
        self._chosen = None if chosen is None else list(chosen)

    def __enter__(self) -> "Kept":
        self._params = (self._project / PARAMS).read_bytes()
        self._lock = self._read_lock()
        self._composed = self._found()
        return self

    def __exit__(self, *error: object) -> None:
        if not self.done:
            self._restore()

    def _restore(self) -> None:
        now = self._found()
        for path in now.keys() - self._composed.keys():
            path.unlink()
        for path, content in self._composed.items():
            if now.get(path) != content:
                write_bytes(path, content)
        path = self._project / PARAMS
        ours = self._chosen is not None and read_overrides(self._project) == self._chosen
        if ours and path.read_bytes() != self._params:
            write_bytes(path, self._params)
            if self._lock is not None and _composed_alone(self._lock, self._read_lock()):
                write_bytes(self._project / LOCK, self._lock)
            print(BACK, file=sys.stderr)

    def _read_lock(self) -> bytes | None:
        path = self._project / LOCK
        return path.read_bytes() if path.exists() else None

    def _found(self) -> dict[Path, bytes]:
        inside = (self._project / COMPOSED).rglob("*")
        return {path: path.read_bytes() for path in inside if path.is_file()}


def _composed_alone(before: bytes, now: bytes | None) -> bool:
    """Whether nothing but the stage `config` differs between two states of `dvc.lock`."""
    import yaml

    try:
        stages = [dict(yaml.safe_load(text or b"")["stages"]) for text in (before, now)]
    except (yaml.YAMLError, KeyError, TypeError, ValueError):
        return False
    for one in stages:
        one.pop("config", None)
    return stages[0] == stages[1]


@contextmanager
def alone(project: Path) -> Iterator[None]:
    """Raises ConfigError where another command of this kind is at work in the project."""
    with (project / "dvc.yaml").open() as handle:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise ConfigError(
                f"another `spirob` is running the pipeline in {project}; wait for its end"
            ) from None
        yield


ROUND = 0.2  # s, longer than DVC takes to write a file


def discard_torn(project: Path) -> list[str]:
    """Delete those files of DVC that are torn; returns their names.

    A file that another DVC is just writing is whole a moment later, and stays.
    """
    import time

    readers: dict[str, Callable[[str], object]] = {
        ".dvc/tmp/rwlock": json.loads,
        "dvc.lock": _lock,
    }
    torn = []
    for name, read in readers.items():
        if _torn(project / name, read):
            time.sleep(ROUND)
            if _torn(project / name, read):
                (project / name).unlink(missing_ok=True)
                torn.append(name)
    return torn


def _lock(text: str) -> object:
    """The content of a `dvc.lock` that DVC would take: a cut one can still be valid YAML.

    Raises ValueError where it is none, where its last line is cut ("hash: md" is valid, and DVC
    fails on it), a value is missing, or what has a hash has no path.
    """
    import yaml

    if not text.endswith("\n"):
        raise ValueError("the last line is cut")
    try:
        found = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise ValueError("no YAML") from error
    if _hollow(found) or _nameless(found):
        raise ValueError("a value is missing")
    return found


def _hollow(found: object) -> bool:
    """Whether a value is missing; what a parameter may be is not DVC's to say."""
    if isinstance(found, dict):
        return any(_hollow(value) for key, value in found.items() if key != "params")
    return any(map(_hollow, found)) if isinstance(found, list) else found is None


def _nameless(found: object) -> bool:
    """Whether an entry with a hash has no path: DVC may write that last."""
    if isinstance(found, dict):
        parts = any(_nameless(value) for key, value in found.items() if key != "params")
        return parts or ("hash" in found and "path" not in found)
    return isinstance(found, list) and any(map(_nameless, found))


def _torn(path: Path, read: Callable[[str], object]) -> bool:
    try:
        return not isinstance(read(path.read_text(encoding="utf-8")), dict)
    except OSError:  # not there, or DVC will say why it cannot be read
        return False
    except ValueError:  # what cannot be decoded is one, too
        return True
