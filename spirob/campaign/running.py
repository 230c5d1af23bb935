"""Many cases in parallel into one file, a line each; what is there already is kept."""

import json
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from joblib import Parallel, delayed
from joblib.externals.loky.process_executor import TerminatedWorkerError

from spirob.campaign.case import Case
from spirob.campaign.diagnosed import result
from spirob.ending import end_with_parent
from spirob.errors import DataError
from spirob.logs.atomic import write_text

ATTEMPTS = 3  # in a row in which workers were killed and no case was finished
Line = dict[str, Any]


def known(path: Path) -> dict[str, Line]:
    """The results of a file by the name of their case; a last line that was cut off is none.

    Raises DataError where another line is no result.
    """
    if not path.exists():
        return {}
    found: dict[str, Line] = {}
    lines = path.read_text().splitlines()
    for k, line in enumerate(lines):
        try:
            one = json.loads(line)
            lacking = bool(one.get("without"))
            found[Case(one["simulator"], one["kind"], one["seed"], lacking).name] = one
        except (ValueError, KeyError, TypeError):
            if k < len(lines) - 1:
                raise DataError(f"{path}: line {k + 1} is no result of a campaign") from None
    return found


def play(
    chosen: Sequence[Case],
    path: Path,
    workers: int,
    tell: Callable[[Case, Line], None] = lambda case, line: None,
) -> list[Line]:
    """Play the cases that have no result in the file yet; all results in the order of `chosen`.

    Where a worker is killed the cases without a result are played again; raises
    TerminatedWorkerError where that brings nothing, three times in a row.
    """
    found = known(path)
    todo, fruitless = _left(chosen, found), 0
    if todo:
        write_text(path, "".join(_text(line) for line in found.values()))  # without a torn end
    while todo:
        try:
            _play(todo, path, workers, found, tell)
        except TerminatedWorkerError:
            fruitless = fruitless + 1 if len(_left(todo, found)) == len(todo) else 0
            if fruitless == ATTEMPTS:
                raise
        todo = _left(todo, found)
    return [found[case.name] for case in chosen]


def _left(chosen: Sequence[Case], found: dict[str, Line]) -> list[Case]:
    return [case for case in chosen if case.name not in found]


def _play(
    todo: Sequence[Case],
    path: Path,
    workers: int,
    found: dict[str, Line],
    tell: Callable[[Case, Line], None],
) -> None:
    jobs = (delayed(_one)(case) for case in todo)
    done = Parallel(n_jobs=workers, return_as="generator_unordered", initializer=end_with_parent)
    with path.open("a") as file:
        for case, line in done(jobs):
            file.write(_text(line))
            file.flush()
            os.fsync(file.fileno())
            found[case.name] = line
            tell(case, line)


def _one(case: Case) -> tuple[Case, Line]:
    return case, result(case)


def _text(line: Line) -> str:
    return json.dumps(line, ensure_ascii=False) + "\n"
