"""Paths that a description names: beside it or below, never elsewhere."""

from pathlib import Path

from spirob.errors import ConfigError


def inside(name: str, folder: Path, what: str) -> Path:
    """`name` under `folder`; raises ConfigError where it leads out of it, by links too."""
    try:
        root = folder.resolve()
        path = (root / name).resolve()
    except (ValueError, OSError, RuntimeError):  # a NUL, too long a name, a loop of links
        raise ConfigError(f"{what}: {name!r} is no path") from None
    if Path(name).is_absolute() or not path.is_relative_to(root):
        raise ConfigError(f"{what}: '{name}' leads out of {folder}")
    return path
