"""Play the trials of the configuration on the robot and decode their logs to tables.

The emulated and the simulated robot are played by the pipeline.  Real drives (robot=can) are moved
by --record alone: it plays the trials on the bus and leaves the logs that the pipeline then reads.
"""

import argparse
import subprocess
import sys
from contextlib import suppress

from spirob.cli.reproduce import add_choices, advance, chosen, taken_up

HELP = "play the trials on the robot, and log them"
ORDER = 20
OWN_END = 1.0  # s: Ctrl-C in a terminal reaches the recording as well


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_choices(parser)
    parser.add_argument("--record", action="store_true", help="move the motors of real hardware")


def run(arguments: argparse.Namespace) -> int:
    """Record where that was asked for, then collect and decode."""
    from spirob.cli.project import Kept

    with Kept(taken_up(arguments), chosen(arguments)) as kept:
        code = _recorded(arguments) if arguments.record else 0
        if code == 0:
            code, project = advance(arguments, "decode")
        kept.done = code == 0
    if code == 0:
        count = len(list((project / "data/traces").glob("*.parquet")))
        print(f"{count} trials in {project / 'data/traces'}")
    return code


def _recorded(arguments: argparse.Namespace) -> int:
    code, project = advance(arguments, "config")
    if code:
        return code
    arguments.choices, arguments.defaults = [], False  # they stand in params.yaml by now
    command = [sys.executable, "-m", "spirob.ending", "pipeline.record"]
    with subprocess.Popen(command, cwd=project) as process:
        try:
            return process.wait()
        except BaseException:
            with suppress(subprocess.TimeoutExpired):
                process.wait(OWN_END)
            process.terminate()  # zero current comes first
            process.wait()
            raise
