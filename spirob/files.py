"""Files: whether one that somebody names can be read, and what it holds; written whole or not.

A file is written under a temporary name, flushed to disk, and renamed.
"""

import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from spirob.errors import ConfigError, DataError, MissingLog


def checked(path: Path | str, what: str) -> Path:
    """The path of a plain file that may be read, `what` being what it should hold.

    Raises MissingLog where there is none, and DataError for whatever else a path may lead to: a
    folder, a pipe or a device, which would never end, or a name that no result could repeat.
    """
    name = named(path)
    try:
        mode = os.stat(name).st_mode
    except (FileNotFoundError, NotADirectoryError):
        raise MissingLog(f"{name}: there is no such {what}") from None
    except OSError as error:  # too long a name, a loop of links, a folder that is closed
        raise DataError(f"{name}: cannot be read: {error.strerror}") from None
    if stat.S_ISDIR(mode):
        raise DataError(f"{name}: is a folder, no {what}")
    if not stat.S_ISREG(mode):
        raise DataError(f"{name}: is a pipe or a device, no {what}")
    if not os.access(name, os.R_OK):
        raise DataError(f"{name}: may not be read")
    return Path(path)


def named(path: Path | str) -> str:
    """The path as text; raises DataError where results could not repeat it."""
    name = os.fspath(path)
    try:
        name.encode("utf-8")  # half a surrogate is how Python keeps what is not
    except UnicodeEncodeError:
        raise DataError(f"{name!r}: the path is not UTF-8; rename it") from None
    if "\0" in name:
        raise DataError(f"{name!r}: a path holds no NUL")
    return name


def content(path: Path | str, what: str, most: int) -> bytes:
    """The bytes of a small file; raises as `checked` does, and DataError beyond `most` bytes."""
    try:
        with open(checked(path, what), "rb") as file:
            found = file.read(most + 1)
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from None
    if len(found) > most:
        raise DataError(f"{path}: more than {most >> 10} KiB is no {what}")
    return found


def inside(name: str, folder: Path, what: str) -> Path:
    """`name` under `folder`; raises ConfigError where it leads out of it, by links too."""
    try:
        root = folder.resolve()
        path = (root / name).resolve()
    except (ValueError, OSError, RuntimeError):  # a NUL, too long a name, a loop of links
        raise ConfigError(f"{what}: {name!r} is no path") from None
    if Path(name).is_absolute() or not path.is_relative_to(root):
        raise ConfigError(f"{what}: '{name}' leads out of {folder}")
    return path


def may_hold_results(folder: Path) -> None:
    """Raise OSError where a folder is none and cannot be made, or nothing can be written there.

    It is tried where it would begin, as permissions do not tell all.
    """
    with suppress(FileNotFoundError, NotADirectoryError):
        os.lstat(folder)  # too long a name
    there = next(p for p in (folder, *folder.absolute().parents) if os.path.lexists(p))
    if not there.is_dir():
        raise NotADirectoryError(20, "is a file, not a folder", str(there))
    try:
        tempfile.TemporaryDirectory(dir=there).cleanup()
    except OSError as error:
        raise OSError(error.errno, f"cannot be written: {error.strerror}", str(there)) from None


def refused(error: OSError) -> str:
    """What the system refused, in a sentence that names the file where it is known."""
    where = f"{error.filename}: " if error.filename else ""
    return f"{where}{error.strerror or error}"


@contextmanager
def refusals_told() -> Iterator[None]:
    """Inside, what the system refuses becomes a DataError."""
    try:
        yield
    except OSError as error:
        raise DataError(refused(error)) from error


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
