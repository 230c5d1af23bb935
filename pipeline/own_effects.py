"""Effect files of one's own: every stage loads the copy that the configuration was checked with.

A copy lies in a folder named by its content: a change of a file is a change of the configuration,
and a stage may replace the file itself, as the next diagnosis does with the law of the last.
"""

import hashlib
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pipeline.schema import Config
from spirob.files import write_text

COPIES = Path("data/config/effects")
DIGITS = 12  # of the content's hash
KEYS = (("plant", "effects"), ("diagnose", "candidates"), ("robot", "effects"))


def with_copies(root: Path, public: dict[str, Any]) -> dict[str, Any]:
    """The configuration as plain data, copies in the place of the files that it names."""
    found = dict(public)
    for part, key in KEYS:
        if key in public[part]:
            found[part] = {**public[part], key: [_copied(root, n) for n in public[part][key]]}
    return found


def _copied(root: Path, name: str) -> str:
    """A name of the library as it is, of a file where its copy lies."""
    if not name.endswith(".py"):
        return name
    text = Path(name).read_text(encoding="utf-8")
    folder = COPIES / hashlib.sha256(text.encode()).hexdigest()[:DIGITS]
    copy = folder / Path(name).name
    write_text(root / copy, text)
    return str(copy)


def given(config: Config, names: Sequence[str]) -> list[str]:
    """Names of effects as they are found: paths of those that the configuration gives as files."""
    told = (*config.plant.effects, *config.diagnose.candidates)
    files = {Path(path).stem: path for path in told if path.endswith(".py")}
    return [files.get(name, name) for name in names]


def lay_beside(root: Path, config: Config, folder: Path) -> None:
    """Copy the files of the model's effects into a folder, where the model that stands lies."""
    for path in config.plant.effects:
        if path.endswith(".py"):
            shutil.copy(root / path, root / folder)
