"""Entry of the command `spirob`: finds the subcommands, runs one, turns errors into sentences.

Exit codes: 0 done, 2 a mistake of the user's, said in one sentence, 130 stopped by Ctrl-C.
Anything else is a bug of ours and shows its traceback.
"""

import argparse
import importlib
import os
import pkgutil
import sys
from collections.abc import Sequence
from types import ModuleType

from spirob.cli import commands
from spirob.errors import SpirobError

MISTAKE, STOPPED = 2, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    parser = argparse.ArgumentParser(
        prog="spirob",
        description="Models a motor-driven machine and names the physical effect its model misses.",
    )
    parser.add_argument("--version", action="store_true", help="print the version and stop")
    choices = parser.add_subparsers(title="commands", metavar="COMMAND")
    for module in subcommands():
        name = command_name(module)
        one = choices.add_parser(name, help=module.HELP, description=module.__doc__)
        module.add_arguments(one)
        one.set_defaults(run=module.run)
    chosen = parser.parse_args(arguments)
    if chosen.version:
        import spirob

        print(spirob.__version__)
        return 0
    if not hasattr(chosen, "run"):
        parser.print_help()
        return MISTAKE
    return _guarded(chosen)


def command_name(module: ModuleType) -> str:
    """What a subcommand is called; `import_.py` is `import`, which no file of Python can be."""
    return module.__name__.rsplit(".", 1)[-1].rstrip("_")


def _guarded(chosen: argparse.Namespace) -> int:
    try:
        return int(chosen.run(chosen) or 0)
    except KeyboardInterrupt:
        print("spirob: stopped", file=sys.stderr)
        return STOPPED
    except BrokenPipeError:  # the reader of our output has gone, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except SpirobError as error:
        print(f"spirob: {' '.join(str(error).split())}", file=sys.stderr)
        return MISTAKE
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        print(f"spirob: {where}{error.strerror or error}", file=sys.stderr)
        return MISTAKE


def subcommands() -> list[ModuleType]:
    """The modules in `commands/`, by name; they import what they need only when they run."""
    found = pkgutil.iter_modules(commands.__path__, f"{commands.__name__}.")
    return [importlib.import_module(info.name) for info in found]


if __name__ == "__main__":
    sys.exit(main())
