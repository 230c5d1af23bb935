"""`spirob trial --rigs`: plays the campaign over simulated axes and prints its table."""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

from spirob.campaign.case import Case, able, cases, together
from spirob.campaign.running import Line, known, play
from spirob.campaign.scoring import DRAWN, KINDS, NONE, law_lines, laws, lines, rates
from spirob.campaign.simulators import SIMULATORS
from spirob.cli.progress import Progress
from spirob.errors import ConfigError
from spirob.files import write_text

OUT = Path("data/campaign.jsonl")
ROBOTS = ("pairs", "scheduler")  # options that axes do not have


def play_rigs(arguments: argparse.Namespace, seeds: Sequence[int]) -> int:
    """Play what is asked for and has no result yet; 0 once all is played."""
    for name in ROBOTS:
        if getattr(arguments, name):
            raise ConfigError(f"--{name}: not with --rigs")
    path = arguments.out or OUT
    simulators = _simulators(arguments.simulators)
    chosen = cases(
        simulators, _kinds(arguments.kinds, simulators), seeds, arguments.nulls, arguments.without
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


def _said(line: Line) -> str:
    if line["said"] is None:
        return str(line["refused"] or line["crashed"].strip().splitlines()[-1])
    hidden = " + ".join(line["truth"]["hidden"]) or "nothing"
    names = [f"{e['name']} ({e['probability']:.0%})" for e in line["said"]["effects"]]
    answer = " + ".join(names) or line["said"]["verdict"]
    return f"{hidden} hidden, {answer}: {line['outcome']['word']}"


def _simulators(chosen: Sequence[str]) -> list[str]:
    for name in chosen:
        if name not in SIMULATORS:
            raise ConfigError(f"--simulators: no '{name}'; there are: {', '.join(SIMULATORS)}")
    return list(chosen) or list(SIMULATORS)


def _kinds(chosen: Sequence[str], simulators: Sequence[str]) -> list[str]:
    """The kinds as they are asked for, each of which a simulator can play."""
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
