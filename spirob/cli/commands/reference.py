"""Print the reference of a module, or write that of all of them, from the docstrings.

Made from the source that is installed, so it is never out of date.
"""

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spirob.cli.reference import Module

HELP = "what a module of the library does, from its docstrings"
ORDER = 90


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `spirob reference`."""
    parser.add_argument("module", nargs="?", help="such as spirob.ports; without it, the list")
    parser.add_argument("--out", metavar="DIR", help="write all modules there, as Markdown")


def run(arguments: argparse.Namespace) -> int:
    """List, print or write."""
    from spirob.cli.reference import modules, page
    from spirob.errors import ConfigError

    found = {module.name: module for module in modules()}
    if arguments.out:
        return _write(found, Path(arguments.out))
    if arguments.module is None:
        width = max(len(name) for name in found)
        for name, module in found.items():
            print(f"{name:{width}}  {module.text.partition(chr(10))[0]}")
        return 0
    if arguments.module not in found:
        raise ConfigError(f"no module '{arguments.module}'; `spirob reference` lists them")
    print(page(found[arguments.module]), end="")
    return 0


def _write(found: "Mapping[str, Module]", folder: Path) -> int:
    from spirob.cli.reference import page
    from spirob.logs.atomic import write_text

    for name, module in found.items():
        write_text(folder / f"{name}.md", page(module))
    lines = [f"- [{name}]({name}.md): {m.text.partition(chr(10))[0]}" for name, m in found.items()]
    write_text(folder / "index.md", "# Reference\n\n" + "\n".join(lines) + "\n")
    print(f"{len(found)} modules in {folder}, from index.md on")
    return 0
