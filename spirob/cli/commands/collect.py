"""Play the trials of the configuration on the robot and decode their logs to tables.

The emulated and the simulated robot are played by the pipeline.  Real drives (robot=can) are moved
by --record alone: it plays the trials on the bus and leaves the logs that the pipeline then reads.
"""

import argparse

from spirob.cli.choices import add_choices, advance

HELP = "play the trials on the robot, and log them"
ORDER = 20


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `spirob collect`."""
    add_choices(parser)
    parser.add_argument("--record", action="store_true", help="move the motors of real hardware")


def run(arguments: argparse.Namespace) -> int:
    """Record where that was asked for, then collect and decode."""
    if arguments.record:
        code, project = advance(arguments, "config")
        code = code or _record(str(project))
        if code:
            return code
        arguments.choices, arguments.defaults = [], False  # they stand in params.yaml by now
    code, project = advance(arguments, "decode")
    if code == 0:
        count = len(list((project / "data/traces").glob("*.parquet")))
        print(f"{count} trials in {project / 'data/traces'}")
    return code


def _record(project: str) -> int:
    import subprocess
    import sys

    from spirob.ending import ended_together

    command = [sys.executable, "-m", "pipeline.record"]
    process = subprocess.Popen(command, cwd=project, text=True)
    with ended_together(process):  # it has time to let the motors go
        return process.wait()
