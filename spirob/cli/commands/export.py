"""Take the model of a diagnosis home: to MuJoCo, to a controller in C, to BAM, as tables.

What was named goes along with the fitted numbers; where the verdict is another one, the fitted
numbers go alone.
"""

import argparse
import sys
from pathlib import Path

from spirob.export import listed, targets
from spirob.files import named

HELP = "write the corrected model for another program"
ORDER = 52

__doc__ = f"{__doc__}\ntargets:\n{listed()}\n"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "diagnosis", metavar="DIR/diagnosis.json", help="what a diagnosis wrote, or its folder"
    )
    parser.add_argument("--to", required=True, metavar="TARGET", help=" | ".join(targets()))
    parser.add_argument("--out", required=True, metavar="OUT", help="folder for the files")
    parser.add_argument(
        "--check",
        action="store_true",
        help="play the held-out logs in what was written, apart from this program, and write both "
        "errors to OUT/check.json",
    )


def run(arguments: argparse.Namespace) -> int:
    """Export and say what was written."""
    from spirob.export.exporting import export

    diagnosis, out = Path(named(arguments.diagnosis)), Path(named(arguments.out))
    done = export(diagnosis, arguments.to, out, arguments.check)
    for said in done.said:
        print(said, file=sys.stderr if said.startswith("LOSES") else sys.stdout)
    print(f"written: {', '.join(map(str, done.files))}")
    return 0
