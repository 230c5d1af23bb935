"""List the library of physical effects, show one, begin a new one, check a file of your own."""

import argparse
import inspect
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from spirob.errors import ConfigError, ExportError
from spirob.files import write_text

if TYPE_CHECKING:
    from spirob.effects import Effect
    from spirob.effects.check import Finding

HELP = "list, show, begin or check physical effects"
ORDER = 70


def add_arguments(parser: argparse.ArgumentParser) -> None:
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


def battery(effect: "type[Effect]", alone: bool) -> tuple[list[str], bool]:
    """Lines that tell of every law, and whether the effect keeps all that were asked.

    alone  leave out the laws of the arm's model
    """
    from spirob.effects.check import LAWS, check
    from spirob.plant.check import check_in_model

    refused = {"exported": said} if (said := exported(effect)) else {}
    broken = _by_law(check(effect))
    lines = [_line(law, test, broken, _absent(law, effect)) for law, test in LAWS.items()]
    lines.append(_line("exported", exported, refused, ""))
    why = "not asked (--alone)" if alone else "not asked: the kernel breaks a law of its own"
    if not (alone or broken):
        broken = _by_law(check_in_model(effect))
        why = ""
    return [*lines, *_of_the_model(effect, broken, why)], not (broken or refused)


def exported(effect: "type[Effect]") -> str:
    """Its kernel can be written as C for `spirob export`."""
    from spirob.export.corrected import Held
    from spirob.export.law import kernel_functions, law_of

    try:
        text = Path(inspect.getfile(effect.kernel)).read_text(encoding="utf-8")
        kernel_functions(Held(law_of(effect.name(), text, effect), {}))
    except ExportError as refused:
        return str(refused)
    return ""


def _by_law(findings: "list[Finding]") -> dict[str, str]:
    laws = dict.fromkeys(finding.law for finding in findings)
    return {law: "; ".join(f.sentence for f in findings if f.law == law) for law in laws}


def _of_the_model(effect: "type[Effect]", broken: dict[str, str], why: str) -> Iterator[str]:
    from spirob.plant.check import LAWS

    for law, test in LAWS.items():
        yield _line(law, test, broken, why or _absent(law, effect))
        if law in broken and not why:
            why = f"not asked, as it breaks '{law}'"


def _line(law: str, test: object, broken: dict[str, str], why: str) -> str:
    if why:
        return f"{law}: {why}"
    if law in broken:
        return f"{law}: broken: {broken[law]}"
    return f"{law}: kept: {(test.__doc__ or '').strip().splitlines()[0]}"


def _absent(law: str, effect: "type[Effect]") -> str:
    """Why this effect has nothing that the law could hold it to; empty where it has."""
    from spirob.ports import PORTS

    if law == "equation" and not effect.equation and effect.state:
        return "does not apply: it states no equation"
    if law in ("evolution", "bounded") and not effect.state:
        return "does not apply: it remembers nothing"
    if law == "evolution" and not effect.evolution:
        return "does not apply: it states no law of its memory"
    if law == "traits" and not effect.traits:
        return "does not apply: it claims none"
    if law == "compiled" and PORTS[effect.port].every == "once":
        return "does not apply: it acts once, before the model runs"
    return ""
