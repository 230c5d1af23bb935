"""Measure how fast the model and what is built on it run, and print the figures.

Rates are of this machine in its present state; ratios are measured in turns within one run.
"""

import argparse
import json

from spirob.errors import ConfigError
from spirob.files import write_text

HELP = "how fast the model runs on this machine"
ORDER = 80


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", metavar="FILE", help="write the figures there, too")
    parser.add_argument("--only", nargs="+", metavar="MEASURE", help="some of the measures")
    parser.add_argument("--tiny", action="store_true", help="one short round: is it in order?")


def run(arguments: argparse.Namespace) -> int:
    """Measure one thing after the other."""
    from spirob.benchmark import MEASURES
    from spirob.benchmark.timing import TINY, Size
    from spirob.progress import Progress

    chosen = arguments.only or list(MEASURES)
    if unknown := [name for name in chosen if name not in MEASURES]:
        raise ConfigError(f"no measure '{unknown[0]}'; measures: {', '.join(MEASURES)}")
    size = TINY if arguments.tiny else Size()
    figures: dict[str, float] = {}
    with Progress(chosen) as progress:
        for name in chosen:
            progress.begin(name)
            figures |= MEASURES[name](size)
            progress.done(name)
    for key, value in figures.items():
        print(f"{key:36s} {value:.4g}")
    if arguments.json:
        write_text(arguments.json, json.dumps(figures, indent=2) + "\n")
    return 0
