"""What the commands that run a part of the pipeline share: their choices, and the run."""

import argparse
from pathlib import Path


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

    Choices that the configuration refuses are taken back.
    """
    from spirob.cli.project import find_project, read_overrides, write_overrides
    from spirob.cli.reproduce import reproduce
    from spirob.cli.stages import stages

    project = find_project(arguments.project)
    stages(project, target)  # a stage that is none is said before anything is changed
    before = read_overrides(project)
    chosen = arguments.choices or arguments.defaults
    if chosen:
        write_overrides(project, arguments.choices)
    outcome = reproduce(project, target, arguments.verbose)
    if chosen and outcome.failed == "config":
        write_overrides(project, before)
    return outcome.code, project
