"""Many cases in parallel into one table, a line a result."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from joblib import delayed, parallel_config

from spirob.campaign import results as table
from spirob.campaign.arm.case import Case, run
from spirob.campaign.arm.rates import answers, is_right
from spirob.campaign.arm.strength import RATIOS
from spirob.diagnosis.criteria import Settings
from spirob.emulator.build import AS_DESIGNED, TYPICAL
from spirob.errors import ConfigError
from spirob.files import write_text

TIMEOUT = 5.0  # s for the scheduler to answer, and then for its first worker


@contextmanager
def cluster(scheduler: str | None) -> Iterator[None]:
    """Inside, joblib's jobs run on the workers of this Dask scheduler; on this machine if None.

    scheduler  address, "tcp://10.0.0.5:8786"

    Raises ConfigError where Dask is not installed, the address does not answer or has no worker.
    """
    if scheduler is None:
        yield
        return
    with _client(scheduler), parallel_config(backend="dask"):
        yield


def _client(scheduler: str) -> Any:
    try:
        from distributed import Client
    except ImportError:
        raise ConfigError(
            f"scheduler {scheduler}: needs Dask, which is not installed: "
            'pip install -e ".[cluster]"'
        ) from None
    try:
        client = Client(scheduler, timeout=TIMEOUT)
    except (OSError, ValueError) as error:
        raise ConfigError(
            f"scheduler {scheduler}: no Dask scheduler answers there within {TIMEOUT:g} s "
            f"({str(error) or type(error).__name__})"
        ) from None
    try:
        client.wait_for_workers(1, timeout=TIMEOUT)
    except TimeoutError:
        client.close()
        raise ConfigError(f"scheduler {scheduler}: it answers, but has no worker") from None
    return client


Result = dict[str, Any]
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
    build: str = TYPICAL,
) -> list[Case]:
    """Every kind with every seed, `nulls` robots with nothing hidden, each pair with every seed.

    ratios  between which knowing what is hidden would bring the held-out error
    build   of every robot, one of `spirob.emulator.build.BUILDS`
    """
    chosen = [
        Case(k, s, without and bool(answers(k)), ratios, build)
        for s in seeds
        for k in kinds
        if k != "none"
    ]
    first = min(seeds, default=0)
    chosen += [Case("none", first + k, build=build) for k in range(nulls)]
    return chosen + [
        Case("+".join(pair), s, False, ratios, build) for s in seeds for pair in PAIRS if pairs
    ]


def known(path: Path) -> list[Result]:
    """The results of a table; see `results.read`."""
    return table.read(path, "trial", _of)


def left(chosen: Sequence[Case], results: Sequence[Result]) -> list[Case]:
    """The cases that have no result yet; one of another robot, build or strength is none."""
    return [case for case in chosen if not _results(case, results)]


def _results(case: Case, results: Sequence[Result]) -> list[Result]:
    """What a case has in the table: one result, two of one that is also played without the answer.

    Empty where one of them is missing.
    """
    found = [one for one in results if _is_of(one, case) and (case.without or not one["without"])]
    return found if len(found) == 1 + case.without else []


def _is_of(one: Mapping[str, Any], case: Case) -> bool:
    ratios = tuple(one.get("ratios", RATIOS))  # a result that says none is of these
    return _of(one) == _place(case) and (one["robot"], ratios) == (case.robot, case.ratios)


def _of(one: Mapping[str, Any]) -> tuple[str, int, str]:
    return one["kind"], one["seed"], one.get("build", AS_DESIGNED)


def _place(case: Case) -> tuple[str, int, str]:
    return case.kind, case.seed, case.build


def play(
    chosen: Sequence[Case],
    path: Path,
    workers: int,
    settings: Settings | None = None,
    tell: Callable[[str], None] = lambda text: None,
    scheduler: str | None = None,
) -> list[Result]:
    """Run the cases that have no result in the table yet; all results in the order of `chosen`.

    workers    processes on this machine
    scheduler  address of a Dask cluster that plays them instead, see `spirob.campaign.arm.running`
    """
    found = known(path)
    todo = left(chosen, found)
    if todo or not path.exists():
        # a line that is cut off goes, and what is played again is not kept beside it
        again = {_place(case) for case in todo}
        found = [one for one in found if _of(one) not in again]
        write_text(path, table.text(found))

    def done(case: Case, results: list[Result], which: str) -> None:
        found.extend(results)
        tell(f"{which}: {_told(case, results)}")

    table.play(
        lambda: left(chosen, found),
        lambda case: delayed(_one)(case, settings),
        path,
        workers,
        done,
        lambda: tell("a worker was killed; the cases without a result are run again"),
        lambda: cluster(scheduler),
    )
    return [one for case in chosen for one in _results(case, found)]


def _one(case: Case, settings: Settings | None) -> tuple[Case, list[Result]]:
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
