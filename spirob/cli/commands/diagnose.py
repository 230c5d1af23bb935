"""Name the physical effect that the model of a machine misses, from its logs and a description.

Writes OUT/diagnosis.json and OUT/index.html.
"""

import argparse
import shlex
import sys
from pathlib import Path

from spirob.files import may_hold_results, named

HELP = "name the missing effect of any motor rig from its logs"
ORDER = 50


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--rig", required=True, metavar="RIG.yaml", help="description of the rig")
    parser.add_argument(
        "--train", required=True, nargs="+", action="extend", metavar="LOG", help="logs to fit"
    )
    parser.add_argument(
        "--test", nargs="+", action="extend", default=[], metavar="LOG", help="logs held out"
    )
    parser.add_argument(
        "--effects",
        nargs="+",
        action="extend",
        default=[],
        metavar="FILE.py",
        help="effects that the model holds besides those of RIG.yaml, whose own files lie beside "
        "it: names, or files of your own, which are run",
    )
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for the results")
    parser.add_argument("--quiet", action="store_true", help="print the verdict only")


def run(arguments: argparse.Namespace) -> int:
    """Diagnose and write."""
    from spirob.machine.diagnosis import diagnose
    from spirob.progress import SearchProgress

    out = Path(named(arguments.out))
    may_hold_results(out)
    with SearchProgress(sys.stderr, arguments.quiet) as progress:
        found = diagnose(
            arguments.rig,
            arguments.train,
            arguments.test,
            progress=progress,
            command=_command(arguments),
            effects=arguments.effects,
        )
    found.save(out)
    for note in found.notes if not arguments.quiet else ():
        print(f"note: {note}", file=sys.stderr)
    print(found.sentence)
    return 0


def _command(arguments: argparse.Namespace) -> str:
    parts = ["spirob", "diagnose", "--rig", arguments.rig, "--train", *arguments.train]
    parts += ["--test", *arguments.test] if arguments.test else []
    parts += ["--effects", *arguments.effects] if arguments.effects else []
    return shlex.join([*parts, "--out", arguments.out])
