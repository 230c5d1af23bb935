"""List the library of physical effects, show one, begin a new one, check a file of your own."""

import argparse
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spirob.effects import Effect

HELP = "list, show, begin or check physical effects"
ORDER = 70


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `spirob effects`."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    actions.add_parser("list", help="all effects, one to a line")
    one = actions.add_parser("show", help="everything about one effect")
    one.add_argument("effect", help="its name, or a file of your own")
    new = actions.add_parser("new", help="write a template for an effect of your own")
    new.add_argument("file", help="file to write, such as brush_bounce.py")
    check = actions.add_parser("check", help="run the tests that every effect has to pass")
    check.add_argument("file", help="file of your own effect, or the name of one of the library")
    check.add_argument(
        "--alone",
        action="store_true",
        help="the kernel's own laws only: for a machine that is not the arm, whose model cannot "
        "show the effect",
    )


def run(arguments: argparse.Namespace) -> int:
    """Do what was asked."""
    actions = {"list": _list, "show": _show, "new": _new, "check": _check}
    return actions[arguments.action](arguments)


def _list(arguments: argparse.Namespace) -> int:
    from spirob.effects import all_effects

    found = all_effects()
    width = max(len(name) for name in found)
    for name, effect in found.items():
        print(f"{name:{width}}  {effect.port:22}  {effect.title}")
    return 0


def _show(arguments: argparse.Namespace) -> int:
    for effect in _found(arguments.effect):
        print(f"{effect.name()}: {effect.title}")
        print(f"\n{effect.explanation}\n{effect.signature}\n")
        print(f"acts at    {effect.port}")
        print(f"reads      {', '.join(effect.reads.values()) or 'nothing'}")
        print(f"law        {effect.equation or (effect.__doc__ or '').strip().splitlines()[0]}")
        print(f"needs      {effect.needs or 'nothing special'}")
        for name, about in effect.parameters().items():
            value = f"{about.nominal:g} [{about.low:g}, {about.high:g}] {about.unit}"
            print(f"number     {name} ({about.symbol}) = {value}: {about.meaning}")
        for rival, experiment in effect.tell_apart.items():
            print(f"not        {rival}: {experiment}")
        for reference in effect.references:
            print(f"source     {reference}")
    return 0


def _new(arguments: argparse.Namespace) -> int:
    from importlib import resources
    from pathlib import Path

    from spirob.errors import ConfigError
    from spirob.files import write_text

    path = Path(arguments.file)
    if path.suffix != ".py" or not path.stem.isidentifier():
        raise ConfigError(f"'{path}': an effect's file is named like it, such as brush_bounce.py")
    if path.exists():
        raise ConfigError(f"'{path}' exists already and is left as it is")
    name = "".join(part.capitalize() for part in path.stem.split("_"))
    template = resources.files("spirob.effects").joinpath("template.py.txt")
    declared = re.compile(r"^class \w+\(", re.MULTILINE)
    write_text(path, declared.sub(f"class {name}(", template.read_text(encoding="utf-8")))
    print(f"{path} written; fill it in, then: spirob effects check {path}")
    return 0


def _check(arguments: argparse.Namespace) -> int:
    from spirob.cli.battery import battery

    sound = True
    for effect in _found(arguments.file):
        # being loaded means that the declaration holds: port, reads, arguments, numbers, neutral
        lines, kept = battery(effect, arguments.alone)
        for line in lines:
            print(f"{effect.name()}: {line}")
        if kept:
            rest = " of its own; the model of the arm was not asked" if arguments.alone else ""
            print(f"{effect.name()}: declared well, keeps every law{rest}")
        sound = sound and kept
    return 0 if sound else 2


def _found(name: str) -> "list[type[Effect]]":
    """The effect of this name, or in this file, which is tried in a process apart before."""
    from spirob.effects import find_effects
    from spirob.machine.loading import tried

    if name.endswith(".py"):
        tried(name, kernel=False)
    return find_effects([name])
