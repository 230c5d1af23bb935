"""Many cases in parallel: each result is a file, so a trial that was stopped goes on."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from joblib import Parallel, delayed
from joblib.externals.loky.process_executor import TerminatedWorkerError

from spirob.diagnosis.rungs import Settings
from spirob.emulator.build import AS_DESIGNED
from spirob.ending import end_with_parent
from spirob.logs.atomic import replacing
from spirob.trial.answers import ANSWERS
from spirob.trial.case import Case, run
from spirob.trial.cluster import cluster
from spirob.trial.rates import is_right
from spirob.trial.strength import RATIOS

ATTEMPTS = 3  # in a row in which workers were killed and no case was finished
PAIRS = (
    ("guide_friction", "current_lag"),
    ("rotor_friction", "joint_creep"),
    ("load_friction", "constant_pull"),
    ("quadratic_drag", "tendon_stretch"),
)


def cases(
    kinds: Sequence[str],
    seeds: Sequence[int],
    nulls: int,
    without: bool = False,
    pairs: bool = False,
    ratios: tuple[float, float] = RATIOS,
    build: str = AS_DESIGNED,
) -> list[Case]:
    """Every kind with every seed, `nulls` robots with nothing hidden, each pair with every seed.

    ratios  between which knowing what is hidden would bring the held-out error
    build   of every robot, one of `spirob.emulator.build.BUILDS`
    """
    chosen = [
        Case(k, s, without and any(_names(k)), ratios, build)
        for s in seeds
        for k in kinds
        if k != "none"
    ]
    first = min(seeds, default=0)
    chosen += [Case("none", first + k, build=build) for k in range(nulls)]
    return chosen + [
        Case("+".join(pair), s, False, ratios, build) for s in seeds for pair in PAIRS if pairs
    ]


def left(chosen: Sequence[Case], folder: Path) -> list[Case]:
    """The cases that have no result yet; one of another robot, build or strength is none."""
    return [case for case in chosen if not _played(_path(folder, case), case)]


def _played(path: Path, case: Case) -> bool:
    if not path.exists():
        return False
    found = json.loads(path.read_text())[0]
    ratios = tuple(found.get("ratios", RATIOS))  # an earlier release had no others
    robot = found.get("robot"), found.get("build", AS_DESIGNED)
    return bool(robot == (case.robot, case.build) and ratios == case.ratios)


def play(
    chosen: Sequence[Case],
    folder: Path,
    workers: int,
    settings: Settings | None = None,
    tell: Callable[[str], None] = lambda text: None,
    scheduler: str | None = None,
) -> list[dict[str, Any]]:
    """Run the cases that have no result yet; all results in the order of `chosen`.

    workers    processes on this machine
    scheduler  address of a Dask cluster that plays them instead, see `spirob.trial.cluster`

    Where a worker is killed (as a machine does that runs out of memory) the cases without a result
    are run again; raises TerminatedWorkerError where that brings nothing, three times in a row.
    """
    todo, fruitless = left(chosen, folder), 0
    while todo:
        try:
            with cluster(scheduler):
                _run(todo, folder, workers, settings, tell)
            break
        except TerminatedWorkerError:
            tell("a worker was killed; the cases without a result are run again")
            before, todo = len(todo), left(chosen, folder)
            fruitless = fruitless + 1 if len(todo) == before else 0
            if fruitless == ATTEMPTS:
                raise
    return [one for case in chosen for one in json.loads(_path(folder, case).read_text())]


def _run(
    todo: Sequence[Case],
    folder: Path,
    workers: int,
    settings: Settings | None,
    tell: Callable[[str], None],
) -> None:
    jobs = (delayed(_one)(case, settings) for case in todo)
    done = Parallel(n_jobs=workers, return_as="generator_unordered", initializer=end_with_parent)(
        jobs
    )
    for k, (case, results) in enumerate(done, 1):
        with replacing(_path(folder, case)) as temporary:  # here: workers may share no disk
            temporary.write_text(json.dumps(results, indent=1) + "\n")
        tell(f"{k} of {len(todo)}: {_told(case, results)}")


def _one(case: Case, settings: Settings | None) -> tuple[Case, list[dict[str, Any]]]:
    return case, run(case, settings)


def _told(case: Case, results: Sequence[Mapping[str, Any]]) -> str:
    whole, error = results[0], results[0]["heldout"]
    mark = "right" if is_right(whole) else "" if case.kind == "none" else "not right"
    blind = "".join(f"; without it: {_said(r)}" for r in results[1:])
    return (
        f"{case.name}: {_said(whole)} {mark}; held-out error {error['base']:.2%}, "
        f"named {error['named']:.2%}, oracle {error['oracle']:.2%}{blind}"
    )


def _said(result: Mapping[str, Any]) -> str:
    return f"{' + '.join(result['named']) or result['verdict']} ({result['probability']:.0%})"


def _path(folder: Path, case: Case) -> Path:
    return folder / f"{case.name}.json"


def _names(kind: str) -> list[str]:
    return [name for part in kind.split("+") for name in ANSWERS[part] if name]
