"""Cases played in parallel into one file, a line for each result; what is there already is kept."""

import json
import os
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any, TypeVar

from joblib import Parallel
from joblib.externals.loky.process_executor import TerminatedWorkerError

from spirob.ending import end_with_parent
from spirob.errors import DataError

ATTEMPTS = 3  # in a row in which workers were killed and no case was finished
Case = TypeVar("Case")
Line = dict[str, Any]


def read(path: Path, what: str, key: Callable[[Line], object]) -> list[Line]:
    """The results of a file; a last line that was cut off is none.

    what  the file is of;  key  of a result, which nothing else has

    Raises DataError where another line is no result.
    """
    if not path.exists():
        return []
    found: list[Line] = []
    lines = path.read_text().splitlines()
    for k, line in enumerate(lines):
        try:
            one = json.loads(line)
            key(one)
            found.append(one)
        except (ValueError, KeyError, TypeError):
            if k < len(lines) - 1:
                raise DataError(f"{path}: line {k + 1} is no result of a {what}") from None
    return found


def text(results: Sequence[Line]) -> str:
    """A line for each."""
    return "".join(json.dumps(one, ensure_ascii=False) + "\n" for one in results)


def play(
    left: Callable[[], Sequence[Case]],
    job: Callable[[Case], Any],
    path: Path,
    workers: int,
    done: Callable[[Case, list[Line], str], None],
    killed: Callable[[], None] = lambda: None,
    where: Callable[[], AbstractContextManager[None]] = nullcontext,
) -> None:
    """Play what is left; each case's results go to the end of the file when it is done.

    job     of joblib, whose answer is the case with its results
    done    gets these and which of how many they are;  killed  is told of each killed worker
    where   context in which jobs run

    Where a worker is killed (as a machine does that runs out of memory) the cases without a result
    are played again; raises TerminatedWorkerError where that brings nothing, three times in a row.
    """
    todo, fruitless = left(), 0
    while todo:
        try:
            with where(), path.open("a") as file:  # here: workers may share no disk
                run = Parallel(
                    workers, return_as="generator_unordered", initializer=end_with_parent
                )
                for k, (case, results) in enumerate(run(map(job, todo)), 1):
                    file.write(text(results))
                    file.flush()
                    os.fsync(file.fileno())
                    done(case, results, f"{k} of {len(todo)}")
        except TerminatedWorkerError:
            killed()
            fruitless = fruitless + 1 if len(left()) == len(todo) else 0
            if fruitless == ATTEMPTS:
                raise
        todo = left()
