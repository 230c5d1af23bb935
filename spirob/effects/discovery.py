"""Find effects by walking the package; a user's own file is found by its path."""

import importlib
import importlib.util
import inspect
import pkgutil
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from types import ModuleType

import spirob.effects
from spirob.effects.effect import Effect
from spirob.errors import EffectError


@cache
def all_effects() -> dict[str, type[Effect]]:
    """Every effect of the library and of installed plug-ins (entry points `spirob.effects`)."""
    found: dict[str, type[Effect]] = {}
    for info in pkgutil.walk_packages(spirob.effects.__path__, "spirob.effects."):
        found.update(_effects_in(importlib.import_module(info.name)))
    for point in entry_points(group="spirob.effects"):
        found.update(_effects_in(importlib.import_module(point.value)))
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
    """The effects defined in a user's own Python file."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None or not path.is_file():
        raise EffectError(f"effect file '{path}' cannot be read")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    found = _effects_in(module)
    if not found:
        raise EffectError(f"effect file '{path}' defines no effect")
    return found


def _effects_in(module: ModuleType) -> dict[str, type[Effect]]:
    classes = inspect.getmembers(module, inspect.isclass)
    own = [c for _, c in classes if issubclass(c, Effect) and c.__module__ == module.__name__]
    return {c.name(): c for c in own if c is not Effect}
