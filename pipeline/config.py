"""Stage `config`: compose conf/ with the overrides of params.yaml, check it, write it resolved.

Two files come out.  data/config/config.yaml is public: every other stage reads it.
data/config/hidden.yaml holds what only the emulated robot knows, and only `collect` reads it.
"""

from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import yaml
from hydra import compose, initialize_config_dir
from hydra.errors import HydraException
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

from pipeline.checks import about, check, hidden_of
from pipeline.own_effects import with_copies
from pipeline.schema import validated
from pipeline.stage import HIDDEN, PUBLIC, entry, read_yaml
from spirob.errors import ConfigError, SpirobError
from spirob.files import write_text
from spirob.unit_table import with_table

REFUSED = (HydraException, OmegaConfBaseException)
NEAREST = 3  # keys that are named beside one that there is none of


def stage(root: Path) -> None:
    """Compose, check and split the configuration."""
    params = read_yaml(root / "params.yaml", "a user") or {}
    overrides = params.get("overrides") if isinstance(params, dict) else None
    if not isinstance(overrides, list) or not all(isinstance(o, str) for o in overrides):
        raise ConfigError("params.yaml: 'overrides' must be a list of strings, e.g. ['rig=spirob']")
    write(root, composed(root, overrides), "params.yaml and conf/")


def composed(root: Path, overrides: list[str]) -> Any:
    """conf/ with overrides as plain data.

    Raises ConfigError naming the override at fault and the nearest keys, or what Hydra says of it.
    """
    folder = root / "conf"
    try:
        return _plain(folder, overrides)
    except REFUSED:
        raise ConfigError(_fault(folder, overrides)) from None


def _plain(folder: Path, overrides: list[str]) -> Any:
    with initialize_config_dir(version_base="1.3", config_dir=str(folder.resolve())):
        plain: Any = OmegaConf.to_container(compose("config", overrides), resolve=True)
    rig = plain.get("rig")
    if isinstance(rig, dict) and isinstance(rig.get("geometry"), dict):
        rig["geometry"] = with_table(rig["geometry"], folder / "rig")
    return plain


def _fault(folder: Path, overrides: list[str]) -> str:
    """Which override is at fault, and why: choices of a group are made first, then the others."""
    groups = [path.name for path in folder.iterdir() if path.is_dir()]
    ordered = sorted(overrides, key=lambda one: _key(one) not in groups)
    count, plain, refused = _longest(folder, ordered)
    if not refused:
        return f"conf/ with overrides {overrides} cannot be composed"
    if count < 0:
        return f"conf/ cannot be composed: {refused}"
    override = ordered[count]
    known = list(dict.fromkeys([*groups, *_named(plain)]))
    if override.startswith("+") or _key(override) in known:
        return f"'{override}': {refused}"
    said = f"'{override}': conf/ lists no '{_key(override)}'"
    if _accepted(folder, [*ordered[:count], f"+{override}"]):
        return f"{said}; a number that only the code knows is added: '+{override}'"
    near = get_close_matches(_key(override), known, NEAREST) or groups
    return f"{said}; nearest: {', '.join(near)}"


def _longest(folder: Path, ordered: list[str]) -> tuple[int, Any, str]:
    """How many of the first overrides compose, to what, and what is said of the next.

    By halves: where some of the first do not compose, more of them do not.
    """
    low, high, middle = -1, len(ordered) + 1, len(ordered)
    plain: Any = {}
    refused = ""
    while high - low > 1:
        try:
            plain, low = _plain(folder, ordered[:middle]), middle
        except REFUSED as error:
            refused = " ".join(str(error).split()).partition(" Config search path")[0]
            high = middle
        middle = (low + high) // 2
    return low, plain, refused


def _accepted(folder: Path, overrides: list[str]) -> bool:
    try:
        check(validated(_plain(folder, overrides), str(folder)))
    except (SpirobError, *REFUSED):
        return False
    return True


def _key(override: str) -> str:
    return override.partition("=")[0].lstrip("~+")


def _named(plain: Any, above: str = "") -> Iterator[str]:
    for key, value in plain.items() if isinstance(plain, dict) else enumerate(plain):
        yield f"{above}{key}"
        if isinstance(value, dict | list):
            yield from _named(value, f"{above}{key}.")


def write(root: Path, plain: Any, source: str) -> None:
    """Check a composed configuration and write its public and its hidden part."""
    config = validated(plain, source)
    with about(source):
        check(config)
        hidden = hidden_of(config)
    public = with_copies(root, config.public())
    write_text(root / HIDDEN, yaml.safe_dump(hidden, sort_keys=False))
    write_text(root / PUBLIC, yaml.safe_dump(public, sort_keys=False, allow_unicode=True))


if __name__ == "__main__":
    entry("config", stage, __doc__)
