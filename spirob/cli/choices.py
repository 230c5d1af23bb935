"""What the commands that run a part of the pipeline share: their choices, and the run."""

import argparse
import sys
from pathlib import Path

BACK = "the choices are taken back: params.yaml and data/config are as before"


def add_choices(parser: argparse.ArgumentParser) -> None:
    """Their arguments."""
    parser.add_argument(
        "choices", nargs="*", metavar="KEY=VALUE", help="such as robot.hidden.effect=cogging"
    )
    parser.add_argument("--defaults", action="store_true", help="forget earlier choices")
    parser.add_argument("--project", metavar="DIR", help="its folder; else the nearest above")
    parser.add_argument("--verbose", action="store_true", help="show what the stages say")


def advance(arguments: argparse.Namespace, target: str | None) -> tuple[int, Path]:
    """Take over the choices and run up to the stage `target`: exit code, and the project's folder.

    Choices of a run that does not come to its end are taken back.
    """
    from spirob.cli.exit_codes import DONE
    from spirob.cli.kept import Kept, alone
    from spirob.cli.project import find_project, read_overrides, write_overrides
    from spirob.cli.reproduce import reproduce
    from spirob.cli.stages import stages

    project = find_project(arguments.project)
    stages(project, target)  # a stage that is none is said before anything is changed
    read_overrides(project)  # and so are choices that cannot be read
    with alone(project), Kept(project, chosen(arguments)) as kept:
        if chosen(arguments) is not None:
            write_overrides(project, arguments.choices)
        code = reproduce(project, target, arguments.verbose).code
        kept.done = code == DONE
    if not kept.done and chosen(arguments) is not None:
        print(BACK, file=sys.stderr)
    return code, project


def chosen(arguments: argparse.Namespace) -> list[str] | None:
    """The choices that this command makes; None where it leaves the earlier ones."""
    return list(arguments.choices) if arguments.choices or arguments.defaults else None
