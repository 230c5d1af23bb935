"""What the commands that run a part of the pipeline share: their choices, and the run."""

import argparse
from pathlib import Path


def add_choices(parser: argparse.ArgumentParser) -> None:
    """Their arguments."""
    parser.add_argument(
        "choices",
        nargs="*",
        metavar="CHOICE",
        help="KEY=VALUE, such as robot.hidden.effect=cogging, or the name of presets: short",
    )
    parser.add_argument("--defaults", action="store_true", help="forget earlier choices")
    parser.add_argument("--project", metavar="DIR", help="its folder; else the nearest above")
    parser.add_argument("--verbose", action="store_true", help="show what the stages say")


def advance(arguments: argparse.Namespace, target: str | None) -> tuple[int, Path]:
    """Take over the choices and run up to the stage `target`: exit code, and the project's folder.

    Choices of a run that does not come to its end are taken back.
    """
    from spirob.cli import DONE
    from spirob.cli.project import Kept, alone, read_overrides, write_overrides
    from spirob.cli.reproduce import reproduce, stages

    project = taken_up(arguments)
    stages(project, target)  # a stage that is none is said before anything is changed
    read_overrides(project)  # and so are choices that cannot be read
    with alone(project), Kept(project, chosen(arguments)) as kept:
        if chosen(arguments) is not None:
            write_overrides(project, arguments.choices)
        code = reproduce(project, target, arguments.verbose).code
        kept.done = code == DONE
    return code, project


def taken_up(arguments: argparse.Namespace) -> Path:
    """The project's folder; names of presets among the choices are spelt out from now on."""
    from spirob.cli.project import find_project, spelt_out

    project = find_project(arguments.project)
    arguments.choices = spelt_out(project, arguments.choices)
    return project


def chosen(arguments: argparse.Namespace) -> list[str] | None:
    """The choices that this command makes; None where it leaves the earlier ones."""
    return list(arguments.choices) if arguments.choices or arguments.defaults else None
