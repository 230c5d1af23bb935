"""Run the pipeline: play the trials, fit, compare, diagnose, estimate sizes, write the report.

Choices KEY=VALUE, or the name of presets (`spirob run short`), replace those in params.yaml and
stay there until others are made; without any, params.yaml is left as it is.  Those of a run that
does not come to its end are taken back.  Only what a change touches runs again.
"""

import argparse
import json

from spirob.cli.reproduce import add_choices, advance

HELP = "the whole pipeline; only what a change touches runs again"
ORDER = 10


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_choices(parser)
    parser.add_argument("--until", metavar="STAGE", help="stop after this stage")


def run(arguments: argparse.Namespace) -> int:
    """Run, then say the verdict and where the page is."""
    code, project = advance(arguments, arguments.until)
    if code == 0 and arguments.until in (None, "decide", "report"):
        found = json.loads((project / "data/diagnosis/diagnosis.json").read_text(encoding="utf-8"))
        print(found["sentence"])
    if code == 0 and arguments.until in (None, "report"):
        print(f"report: {project / 'reports/index.html'}")
    if code == 0 and arguments.choices:
        print("these choices stay in params.yaml; the way back: spirob run --defaults")
    return code
