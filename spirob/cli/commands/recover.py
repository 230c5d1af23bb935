"""Bring back what a torn or damaged MCAP log still holds: every whole chunk, metadata, attachments.

FILE is left as it is; FILE2 is a whole file that every reader takes.
"""

import argparse
import sys

HELP = "bring back what a torn MCAP log still holds"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", metavar="FILE", help="torn or damaged MCAP file, also a *.part")
    parser.add_argument("--out", required=True, metavar="FILE2", help="file to write")


def run(arguments: argparse.Namespace) -> int:
    """Recover and say what came back."""
    from spirob.logs.recovery import recover

    done = recover(arguments.file, arguments.out)
    for note in done.notes:
        print(f"note: {note}", file=sys.stderr)
    print(
        f"{arguments.out}: {done.messages} messages of {done.chunks} chunks, "
        f"{done.attachments} attachments, {done.metadata} metadata records"
    )
    return 0
