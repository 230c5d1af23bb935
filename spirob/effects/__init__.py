"""One file per physical effect; see `effects.effect` for what such a file declares.

The library is found by walking this package, a user's own file by its path; `table` lists it.

effect.py  what an effect is;  generated.py  its kernel as text in a generated loop
formula.py  what a kernel may hold, so that it comes to an end
check.py   the laws that every effect is held to;  replay.py  the signals they are run on
"""

import importlib
import importlib.util
import inspect
import pkgutil
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from types import ModuleType

from spirob.effects.effect import Effect
from spirob.effects.formula import open_end
from spirob.errors import EffectError, SpirobError


@cache
def all_effects() -> dict[str, type[Effect]]:
    """Every effect of the library and of installed plug-ins (entry points `spirob.effects`)."""
    found: dict[str, type[Effect]] = {}
    names = [i.name for i in pkgutil.walk_packages(__path__, f"{__name__}.")]
    names += [point.value for point in entry_points(group="spirob.effects")]
    for module in names:
        for name, effect in _effects_in(importlib.import_module(module)).items():
            if found.setdefault(name, effect) is not effect:
                other = found[name].__module__
                raise EffectError(f"effect '{name}' is in two files: {other} and {module}")
    return dict(sorted(found.items()))


def find_effects(names: list[str]) -> list[type[Effect]]:
    """The effects with these names, in this order; a name that ends in `.py` is a user's file.

    Raises EffectError naming what exists, when a name is unknown.
    """
    known = all_effects()
    chosen: list[type[Effect]] = []
    for name in names:
        if name.endswith(".py"):
            chosen.extend(load_file(Path(name)).values())
        elif name in known:
            chosen.append(known[name])
        else:
            raise EffectError(f"no effect '{name}'; known: {', '.join(known)}")
    return chosen


def load_file(path: Path) -> dict[str, type[Effect]]:
    """The effects defined in a user's own Python file; the same classes while it stays as it is.

    Raises EffectError when the file is absent, does not run, declares wrongly, holds no effect, or
    one with a kernel that need not come to an end.
    """
    try:
        return _loaded(path.resolve(), path.read_bytes())
    except OSError:
        raise EffectError(f"effect file '{path}' cannot be read") from None
    except EffectError as wrong:
        raise EffectError(f"effect file '{path}'{wrong}") from wrong


@cache
def _loaded(path: Path, content: bytes) -> dict[str, type[Effect]]:
    """The effects of a file with this content; raises EffectError with what is wrong with it."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None:
        raise EffectError(" cannot be read")
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except SpirobError as wrong:
        raise EffectError(f": {wrong}") from wrong
    except (Exception, SystemExit) as wrong:  # whatever a user's file does becomes a sentence
        raise EffectError(f" fails: {type(wrong).__name__}: {wrong}") from wrong
    if not (found := _effects_in(module)):
        raise EffectError(" defines no effect")
    for effect in found.values():
        if said := open_end(effect.kernel):
            raise EffectError(f": {said}")
    return found


def _effects_in(module: ModuleType) -> dict[str, type[Effect]]:
    classes = inspect.getmembers(module, inspect.isclass)
    own = [c for _, c in classes if issubclass(c, Effect) and c.__module__ == module.__name__]
    own = [c for c in own if c is not Effect]
    if len(own) > 1:
        names = " and ".join(c.__name__ for c in own)
        raise EffectError(f"{module.__name__} defines {names}; an effect is one file")
    return {c.name(): c for c in own}


HEAD = ("| effect | acts on | numbers | shows as | needs |", "|---|---|---|---|---|")


def table() -> str:
    """All effects by place, as Markdown; at zero of its numbers in bold an effect is absent."""
    found = all_effects().values()
    places = sorted({_place(effect) for effect in found})
    parts = []
    for place in places:
        rows = [_row(effect) for effect in found if _place(effect) == place]
        parts.append("\n".join([f"### {place}", "", *HEAD, *rows]))
    return "\n\n".join(parts) + "\n"


def _place(effect: type[Effect]) -> str:
    return effect.__module__.split(".")[-2]


def _row(effect: type[Effect]) -> str:
    numbers = []
    for name, about in effect.parameters().items():
        shown = f"**{about.symbol}**" if name in effect.neutral else about.symbol
        unit = "" if about.unit == "1" else f" {about.unit}"
        numbers.append(f"{shown} {about.nominal:g}{unit} ({about.meaning})")
    who = f"`{effect.name()}`<br>{effect.title}"
    cells = (who, f"`{effect.port}`", "<br>".join(numbers), effect.signature, effect.needs)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


__all__ = ["Effect", "all_effects", "find_effects", "load_file"]
