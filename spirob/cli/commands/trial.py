"""Test the diagnosis: robots with a hidden effect, diagnosed blind, and scored.

Every case is a robot of its own (kind and seed), recorded over the bus, fitted, diagnosed and then
compared with what was hidden.  A case takes about a minute of processor time, and with
`--without` most robots are two cases; one file holds all results, a line each.  What is there
already is kept, so a trial that was stopped goes on.

With `--rigs` the machines are simulated axes of other people's kind, diagnosed as `spirob diagnose
--rig` does.
"""

import argparse
import json
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from spirob.errors import ConfigError
from spirob.files import write_text

if TYPE_CHECKING:
    from spirob.campaign.running import Line
    from spirob.progress import Progress

HELP = "how often the diagnosis names what was hidden"
ORDER = 75
OVER = re.compile(r"\d+ of \d+: (?P<case>[^:]+):")  # how a case's line begins


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--seeds", default="0:2", metavar="A:B", help="from A up to B (%(default)s)"
    )
    parser.add_argument(
        "--kinds", nargs="+", default=[], metavar="KIND", help="of hidden effects, a+b for two; all"
    )
    parser.add_argument(
        "--nulls", type=int, default=0, metavar="N", help="robots with nothing hidden (%(default)s)"
    )
    parser.add_argument(
        "--pairs", action="store_true", help="four pairs of effects with every seed, besides"
    )
    parser.add_argument(
        "--without", action="store_true", help="each case again with the right effect disabled"
    )
    parser.add_argument(
        "--ratios",
        default="0.3:0.35",
        metavar="A:B",
        help="how strong an effect is: knowing it would bring the held-out error to between A and"
        " B of what it is (%(default)s)",
    )
    parser.add_argument(
        "--build",
        default="typical",
        metavar="BUILD",
        help="how the robots are built: as_designed, typical or rough (%(default)s)",
    )
    parser.add_argument(
        "--rigs", action="store_true", help="simulated axes in place of robots: servos, slides, ..."
    )
    parser.add_argument(
        "--disturbed",
        action="store_true",
        help="with --rigs: a force that wanders in each, 5 to 30 %% of the effort",
    )
    parser.add_argument(
        "--simulators", nargs="+", default=[], metavar="NAME", help="of axes, with --rigs; all"
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="all results (data/trial.jsonl, with --rigs data/campaign.jsonl)",
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the rates there")
    parser.add_argument("--workers", type=int, default=-1, metavar="N", help="processes; all cores")
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="play the cases on the Dask cluster of this scheduler, tcp://10.0.0.5:8786",
    )


def run(arguments: argparse.Namespace) -> int:
    """Play the cases and print the rates."""
    from spirob.campaign.arm.rates import rates
    from spirob.campaign.arm.running import cases, known, left, play
    from spirob.emulator.build import require_build
    from spirob.progress import Progress

    seeds = _seeds(arguments.seeds)
    if arguments.out and arguments.out.is_dir():
        raise ConfigError(f"--out {arguments.out}: needs a file, not a folder")
    if arguments.rigs:
        return play_rigs(arguments, seeds)
    for name in AXES_ONLY:
        if getattr(arguments, name):
            raise ConfigError(f"--{name}: with --rigs only")
    out = arguments.out or Path("data/trial.jsonl")
    kinds, ratios = _kinds(arguments.kinds), _ratios(arguments.ratios)
    require_build(arguments.build)
    chosen = cases(
        kinds,
        seeds,
        arguments.nulls,
        arguments.without,
        arguments.pairs,
        ratios,
        arguments.build,
    )
    with Progress([case.name for case in left(chosen, known(out))]) as progress:
        results = play(
            chosen,
            out,
            arguments.workers,
            tell=_told(progress),
            scheduler=arguments.scheduler,
        )
    found = rates(results)
    for name, one in found.items():
        if isinstance(one, dict) and "low" in one and one["n"]:
            print(
                f"{name:22s} {one['value']:.1%} [{one['low']:.1%}, {one['high']:.1%}] of {one['n']}"
            )
    if arguments.json:
        write_text(arguments.json, json.dumps(found, indent=1) + "\n")
    return 0


def _told(progress: "Progress") -> Callable[[str], None]:
    def tell(text: str) -> None:
        if over := OVER.match(text):
            progress.done(over["case"], said=text)
        else:
            progress.tell(text)

    return tell


def _seeds(text: str) -> list[int]:
    first, colon, last = text.partition(":")
    try:
        seeds = list(range(int(first), int(last) if colon else int(first) + 1))
    except ValueError:
        seeds = []
    if not seeds or seeds[0] < 0:
        raise ConfigError(f"--seeds {text}: needs A:B with 0 <= A < B, or one number")
    return seeds


def _ratios(text: str) -> tuple[float, float]:
    first, _, last = text.partition(":")
    try:
        ratios = float(first), float(last)
    except ValueError:
        ratios = 0.0, 0.0
    if not 0.0 < ratios[0] < ratios[1] < 1.0:
        raise ConfigError(f"--ratios {text}: needs A:B with 0 < A < B < 1")
    return ratios


def _kinds(chosen: list[str]) -> list[str]:
    from spirob.campaign.arm.strength import VISIBLE

    for kind in chosen:
        for part in kind.split("+"):
            if part not in VISIBLE:
                raise ConfigError(f"--kinds: no kind '{part}'; kinds: {', '.join(sorted(VISIBLE))}")
    return chosen or list(VISIBLE)


CAMPAIGN = Path("data/campaign.jsonl")
ROBOTS_ONLY = ("pairs", "scheduler")  # options that axes do not have
AXES_ONLY = ("disturbed", "simulators")  # that robots do not have


def play_rigs(arguments: argparse.Namespace, seeds: Sequence[int]) -> int:
    """Play simulated axes that have no result yet; 0 once all are played."""
    from spirob.campaign.case import Case, cases
    from spirob.campaign.running import Line, known, play
    from spirob.campaign.scoring import law_lines, laws, lines, rates
    from spirob.progress import Progress

    for name in ROBOTS_ONLY:
        if getattr(arguments, name):
            raise ConfigError(f"--{name}: not with --rigs")
    path = arguments.out or CAMPAIGN
    simulators = _simulators(arguments.simulators)
    chosen = cases(
        simulators,
        _rig_kinds(arguments.kinds, simulators),
        seeds,
        arguments.nulls,
        arguments.without,
        arguments.disturbed,
    )
    there = known(path)
    with Progress([case.name for case in chosen if case.name not in there]) as progress:

        def tell(case: Case, line: Line) -> None:
            progress.done(case.name, said=f"{case.name}: {_said(line)}; {progress.left()} left")

        results = play(chosen, path, arguments.workers, tell)
    table = rates(results)
    print("\n".join(lines(table)))
    if composed := laws(results):
        print("\n".join(["", *law_lines(composed)]))
    if arguments.json:
        write_text(arguments.json, json.dumps({**table, "laws": composed}, indent=1) + "\n")
    return 0


def _said(line: "Line") -> str:
    if line["said"] is None:
        return str(line["refused"] or line["crashed"].strip().splitlines()[-1])
    hidden = " + ".join(line["truth"]["hidden"]) or "nothing"
    names = [f"{e['name']} ({e['probability']:.0%})" for e in line["said"]["effects"]]
    answer = " + ".join(names) or line["said"]["verdict"]
    return f"{hidden} hidden, {answer}: {line['outcome']['word']}"


def _simulators(chosen: Sequence[str]) -> list[str]:
    from spirob.campaign.simulators import SIMULATORS

    for name in chosen:
        if name not in SIMULATORS:
            raise ConfigError(f"--simulators: no '{name}'; there are: {', '.join(SIMULATORS)}")
    return list(chosen) or list(SIMULATORS)


def _rig_kinds(chosen: Sequence[str], simulators: Sequence[str]) -> list[str]:
    """The kinds as they are asked for, each of which a simulator can play."""
    from spirob.campaign.case import able, together
    from spirob.campaign.scoring import DRAWN, KINDS, NONE

    for kind in chosen:
        parts = [] if kind in (NONE, *DRAWN) else kind.split("+")
        for part in parts:
            if part not in KINDS:
                whole = ", ".join([NONE, *sorted(KINDS), *DRAWN])
                raise ConfigError(f"--kinds: no kind '{part}'; kinds: {whole}")
        if not together(parts):
            raise ConfigError(f"--kinds {kind}: an axis has one of these at a time")
        if not any(able(simulator, kind) for simulator in simulators):
            raise ConfigError(f"--kinds {kind}: none of {', '.join(simulators)} plays it")
    return list(chosen)
