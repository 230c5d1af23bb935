"""Kernels of effects as text: pasted into the loops that the program generates, and called there.

Numba's disk cache does not notice a change in an imported function, but it does notice a new file;
so what a loop needs is in its own source.  That is a module for each loop, kept on disk with what
Numba made, and its name is a hash of its content (`load`).
"""

import hashlib
import importlib.util
import inspect
import os
import re
import sys
import tempfile
import textwrap
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from pathlib import Path
from types import ModuleType

from spirob.effects.effect import Effect
from spirob.ending import at_end

# only what is compiled with it calls it: no entry for Python, nothing of its own on disk
CALLED = "no_cpython_wrapper=True, no_cfunc_wrapper=True"
MARKED = f"@njit({CALLED})\n"
ENTRY = "@njit(cache=True)\n"


def pasted(functions: Iterable[Callable[..., object]], mark: str = MARKED) -> list[str]:
    """The text of compiled functions under their own names."""
    return [mark + text(f, f.__name__) for f in functions]


def kernels(effects: Iterable[type[Effect]]) -> list[str]:
    """The text of compiled kernels under the names by which `call` calls them."""
    return [MARKED + text(e.kernel, f"kernel_{e.name()}") for e in effects]


def call(
    effect: type[Effect],
    upstream: str,
    dt: str,
    reads: Mapping[str, str],
    states: Mapping[str, str],
    numbers: Mapping[str, str],
) -> str:
    """The expression that calls an effect's kernel, of the expressions that it is given.

    reads  of its signals by name, at least those that it reads;  states, numbers  by its own names
    """
    places = {"upstream": upstream, "dt": dt, **states, **numbers}
    places |= {argument: reads[signal] for argument, signal in effect.reads.items()}
    return f"kernel_{effect.name()}({', '.join(places[a] for a in effect.arguments())})"


def text(function: Callable[..., object], name: str) -> str:
    """The text of a function, under another name and without its decorators."""
    source = textwrap.dedent(inspect.getsource(function)).replace("@staticmethod\n", "")
    return re.sub(r"def \w+\(", f"def {name}(", source, count=1)


@cache
def load(source: str, kind: str) -> ModuleType:
    """The module of a generated source, named after its kind and compiled at its first call."""
    name = f"{kind}_{hashlib.sha256(source.encode()).hexdigest()[:20]}"
    try:
        path = _written(_kept(), name, source)
    except OSError:  # a home that cannot be written costs a compilation each time, nothing else
        path = _written(Path(_passing().name), name, source)
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # numba's cache imports it by name
    spec.loader.exec_module(module)
    return module


def _kept() -> Path:
    folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "spirob"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@cache
def _passing() -> tempfile.TemporaryDirectory[str]:
    """The one folder of this process, removed at its end."""
    folder = tempfile.TemporaryDirectory(prefix="spirob_")
    at_end(folder.cleanup)
    return folder


def _written(folder: Path, name: str, source: str) -> Path:
    path = folder / f"{name}.py"
    if not path.exists() or path.read_text(encoding="utf-8") != source:
        with tempfile.NamedTemporaryFile(
            "w", dir=folder, suffix=".py", delete=False, encoding="utf-8"
        ) as file:
            file.write(source)
        os.replace(file.name, path)
    return path
