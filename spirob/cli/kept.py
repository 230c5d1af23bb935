"""What a run that does not end well leaves as it was: the choices, and the composed configuration.

Whatever ends it (a refusal of any stage, a busy lock of DVC, Ctrl-C, SIGTERM), both come back, each
file in one go.  Choices that somebody else has made meanwhile stay.
"""

import fcntl
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType

from spirob.cli.project import read_overrides
from spirob.errors import ConfigError
from spirob.logs.atomic import write_bytes

PARAMS = "params.yaml"
BACK = "the choices are taken back: params.yaml and data/config are as before"
COMPOSED = Path("data/config")


class Kept:
    """Restores a project's choices and composed configuration on leaving, unless `done` is set.

    chosen  what the run puts into params.yaml; None where it leaves that file alone
    """

    def __init__(self, project: Path, chosen: Sequence[str] | None):
        self.done = False
        self._project = project
        self._chosen = None if chosen is None else list(chosen)

    def __enter__(self) -> "Kept":
        self._params = (self._project / PARAMS).read_bytes()
        self._composed = self._found()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
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
            print(BACK, file=sys.stderr)

    def _found(self) -> dict[Path, bytes]:
        inside = (self._project / COMPOSED).rglob("*")
        return {path: path.read_bytes() for path in inside if path.is_file()}


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
