"""Files appear whole or not at all: write under a temporary name, flush to disk, rename."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: Path | str) -> Iterator[Path]:
    """A temporary path in the same folder that becomes `path` if the block succeeds.

    The folder is made if need be.  On an exception the temporary file is removed and whatever
    `path` held before stays as it was.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    # The process number keeps two writers of one name apart; the last to finish wins.
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield temporary
        publish(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def publish(temporary: Path, path: Path) -> None:
    """Bring a finished file to disk and give it its name; both lie in the same folder."""
    _sync(temporary)
    os.replace(temporary, path)
    _sync(path.parent)


def write_bytes(path: Path | str, content: bytes) -> None:
    """Write a whole file at once."""
    with replacing(path) as temporary:
        temporary.write_bytes(content)


def write_text(path: Path | str, content: str) -> None:
    """Write a whole UTF-8 text file at once, with line ends as they are in `content`.

    What is no text in it, as in a file's name of any bytes, becomes a question mark.
    """
    write_bytes(path, content.encode("utf-8", "replace"))


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
