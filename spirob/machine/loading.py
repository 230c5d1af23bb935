"""`RIG.yaml` from disk: data, never code; a mistake is an error that says where it stands."""

from collections.abc import Mapping
from pathlib import Path

from pydantic import ValidationError

from spirob import given_file, plain_yaml
from spirob.errors import ConfigError
from spirob.machine.arm.description import ArmFile
from spirob.machine.rig import RigFile

LARGEST = 2**18  # bytes of a description


def load_rig(path: Path | str) -> tuple[RigFile | ArmFile, Path]:
    """The description, of a rig or of our arm, and its folder, from which its paths count.

    Raises MissingLog where there is no file, DataError where it is none that can be read, and
    ConfigError with the place of the first mistake.
    """
    content = plain_yaml.read(given_file.content(path, "rig description", LARGEST), str(path))
    return described(content, str(path)), Path(path).parent


def described(content: object, where: str) -> RigFile | ArmFile:
    """The description in plain data; raises ConfigError naming `where` and the first mistake."""
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
        said = "no such key; docs/rig_keys.md lists all"
    more = error.error_count() - 1
    return f"{place + ': ' if place else ''}{said}" + (f" (and {more} more)" if more else "")
