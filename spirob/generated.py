"""Source that the program writes for itself: a module for each, kept on disk with what Numba made.

The name of a module is a hash of its content.
"""

import hashlib
import importlib.util
import os
import sys
import tempfile
from functools import cache
from pathlib import Path
from types import ModuleType


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
    return tempfile.TemporaryDirectory(prefix="spirob_")


def _written(folder: Path, name: str, source: str) -> Path:
    path = folder / f"{name}.py"
    if not path.exists() or path.read_text(encoding="utf-8") != source:
        with tempfile.NamedTemporaryFile(
            "w", dir=folder, suffix=".py", delete=False, encoding="utf-8"
        ) as file:
            file.write(source)
        os.replace(file.name, path)
    return path
