"""What a kill may leave of DVC's own two files.

DVC rewrites its lock table and `dvc.lock` in place, so a SIGKILL in that very moment leaves a torn
file, and DVC then refuses to run.  Both only record what ran: without the table nothing is locked,
and without `dvc.lock` the results come back from the cache.
"""

import json
from collections.abc import Callable
from pathlib import Path

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
    fails on it) or a value is missing.
    """
    import yaml

    if not text.endswith("\n"):
        raise ValueError("the last line is cut")
    try:
        found = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise ValueError("no YAML") from error
    if _hollow(found):
        raise ValueError("a value is missing")
    return found


def _hollow(found: object) -> bool:
    """Whether a value is missing; what a parameter may be is not DVC's to say."""
    if isinstance(found, dict):
        return any(_hollow(value) for key, value in found.items() if key != "params")
    return any(map(_hollow, found)) if isinstance(found, list) else found is None


def _torn(path: Path, read: Callable[[str], object]) -> bool:
    try:
        return not isinstance(read(path.read_text(encoding="utf-8")), dict)
    except OSError:  # not there, or DVC will say why it cannot be read
        return False
    except ValueError:  # what cannot be decoded is one, too
        return True
