"""`RIG.yaml` from disk: data, never code; a mistake is an error that says where it stands."""

from collections.abc import Mapping
from pathlib import Path

import yaml
from pydantic import ValidationError

from spirob.errors import ConfigError, MissingLog
from spirob.machine.arm.description import ArmFile
from spirob.machine.rig import RigFile

LARGEST = 2**18  # bytes of a description


def load_rig(path: Path | str) -> tuple[RigFile | ArmFile, Path]:
    """The description, of a rig or of our arm, and its folder, from which its paths count.

    Raises MissingLog where there is no file, ConfigError with the place of the first mistake.
    """
    path = Path(path)
    if not path.is_file():
        raise MissingLog(f"{path}: there is no such rig description")
    if path.stat().st_size > LARGEST:
        raise ConfigError(f"{path}: {path.stat().st_size} bytes are no description of a rig")
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeError, RecursionError) as error:
        said = " ".join(str(error).split())
        raise ConfigError(f"{path}: this is no YAML: {said[:200]}") from error
    return rig_from(content, str(path)), path.parent


def rig_from(content: object, where: str) -> RigFile | ArmFile:
    """A description from plain data; raises ConfigError naming `where` and the first mistake."""
    if not isinstance(content, Mapping):
        raise ConfigError(f"{where}: a rig is a mapping of keys, got {type(content).__name__}")
    kind: type[RigFile] | type[ArmFile] = ArmFile if content.get("body") == "arm" else RigFile
    try:
        return kind.model_validate(dict(content))
    except ValidationError as error:
        raise ConfigError(f"{where}: {_first(error)}") from error


def _first(error: ValidationError) -> str:
    wrong = error.errors()[0]
    place = ".".join(str(part) for part in wrong["loc"])
    said = wrong["msg"].removeprefix("Value error, ")
    if wrong["type"] == "extra_forbidden":
        said = "no such key; see docs/any_rig.md"
    more = error.error_count() - 1
    return f"{place + ': ' if place else ''}{said}" + (f" (and {more} more)" if more else "")
