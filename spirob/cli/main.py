"""Entry of the command `spirob`: finds the subcommands, runs one, turns errors into sentences.

What the exit codes mean stands in `spirob.cli`.
"""

import argparse
import atexit
import importlib
import os
import pkgutil
import sys
from collections.abc import Sequence
from contextlib import suppress
from types import ModuleType

from spirob.cli import DONE, MEANINGS, MISTAKE, STOPPED, commands
from spirob.ending import stop_as_by_hand, tidy
from spirob.errors import SpirobError
from spirob.files import refused

ABOUT = """\
Models a motor-driven machine and names the physical effect its model misses.

the way, in the project's folder:
  spirob run                                    play, fit, diagnose, report
  spirob report --open                          read the verdict
  spirob run robot.hidden.effect=cogging        hide another effect; can it be found?
  spirob run 'plant.effects=[capstan_friction]' add one to the model; the error falls
and with logs of a machine of your own:
  spirob diagnose --rig RIG.yaml --train A.csv --test B.csv --out DIR
"""
ENDING = "exit codes:\n" + "\n".join(f"  {code:<10} {text}" for code, text in MEANINGS.items())


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    parser = command_line()
    chosen = parser.parse_args(arguments)
    if chosen.version:
        import spirob

        print(spirob.__version__)
        return DONE
    if not hasattr(chosen, "run"):
        parser.print_help()
        return MISTAKE
    stop_as_by_hand()
    code = _guarded(chosen)
    if code and arguments is None:  # as a program of its own, whose end is near
        atexit.register(_end, code)
    return code


def command_line() -> argparse.ArgumentParser:
    """The parser with all subcommands."""
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(
        prog="spirob",
        usage="spirob [--version] COMMAND ...   (spirob COMMAND --help tells more)",
        description=f"{ABOUT}\ncommands:\n{listed(subcommands())}\n\n{ENDING}",
        formatter_class=raw,
        add_help=False,
    )
    parser.add_argument("-h", "--help", action="help", help=argparse.SUPPRESS)
    parser.add_argument("--version", action="store_true", help=argparse.SUPPRESS)
    choices = parser.add_subparsers(metavar="COMMAND", prog="spirob", help=argparse.SUPPRESS)
    for module in subcommands():
        one = choices.add_parser(
            name_of(module), help=module.HELP, description=module.__doc__, formatter_class=raw
        )
        module.add_arguments(one)
        one.set_defaults(run=module.run)
    return parser


def listed(modules: Sequence[ModuleType]) -> str:
    """The subcommands, one to a line."""
    return "\n".join(f"  {name_of(module):<10} {module.HELP}" for module in modules)


def _guarded(chosen: argparse.Namespace) -> int:
    try:
        return int(chosen.run(chosen) or DONE)
    except KeyboardInterrupt:
        print("spirob: stopped", file=sys.stderr)
        return STOPPED
    except BrokenPipeError:  # the reader of our output has gone, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except SpirobError as error:
        print(f"spirob: {' '.join(str(error).split())}", file=sys.stderr)
        return MISTAKE
    except OSError as error:
        print(f"spirob: {refused(error)}", file=sys.stderr)
        return MISTAKE


def _end(code: int) -> None:
    """End with this code, before what an effect of one's own has registered for the end."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # its reader has gone, or it is closed
            stream.flush()
    tidy()
    os._exit(code)


def subcommands() -> list[ModuleType]:
    """The modules in `commands/`, in the order of use; they import what they need when they run."""
    found = pkgutil.iter_modules(commands.__path__, f"{commands.__name__}.")
    modules = [importlib.import_module(info.name) for info in found]
    return sorted(modules, key=lambda module: (getattr(module, "ORDER", 60), name_of(module)))


def name_of(module: ModuleType) -> str:
    """The subcommand's name: that of its file, where a keyword of Python ends in _ (`import_`)."""
    return module.__name__.rsplit(".", 1)[-1].rstrip("_").replace("_", "-")


if __name__ == "__main__":
    sys.exit(main())
