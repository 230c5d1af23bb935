"""From a diagnosis on disk to files of a target, each whole or not at all."""

import json
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path

from spirob.errors import ExportError
from spirob.export import targets
from spirob.export.checking import played, sentence, warning
from spirob.export.corrected import Corrected, corrected, read_document
from spirob.export.heldout import there
from spirob.logs.atomic import write_text

COMMENTS = {
    ".c": ("/* ", " */"),
    ".h": ("/* ", " */"),
    ".py": ("# ", ""),
    ".xml": ("<!-- ", " -->"),
}


@dataclass(frozen=True)
class Exported:
    """What was written: files, and sentences about them."""

    files: tuple[Path, ...]
    said: tuple[str, ...]


def export(diagnosis: Path, to: str, out: Path, check: bool = False) -> Exported:
    """Write the model of a diagnosis for a target.

    diagnosis  `diagnosis.json`, or the folder that holds it
    check      play the held-out logs in what was written

    Raises ExportError in a sentence; then nothing is written.
    """
    path = diagnosis / "diagnosis.json" if diagnosis.is_dir() else diagnosis
    known = targets()
    if to not in known:
        raise ExportError(f"no target '{to}'; there are: {', '.join(known)}")
    if out.exists() and not out.is_dir():
        raise NotADirectoryError(20, "is a file, not a folder", str(out))
    model = corrected(read_document(path), path.parent)
    made = known[to].files(model)
    if check and not known[to].PLAYER:
        raise ExportError(f"'{to}' holds nothing that could be played; leave --check away")
    said: list[str] = []
    if known[to].PLAYER and (check or (known[to].LOSSY and there(path.parent))):
        made, said = _proved(model, known[to].PLAYER, made)
    for name, text in made.items():
        write_text(out / name, text)
    return Exported(tuple(out / name for name in made), tuple(said))


def _proved(
    model: Corrected, player: str, made: dict[str, str]
) -> tuple[dict[str, str], list[str]]:
    """The files, each with what it loses in its first line, and what the proof says."""
    with tempfile.TemporaryDirectory() as place:
        for name, text in made.items():
            write_text(Path(place) / name, text)
        errors = played(model, player, Path(place))
    said = [sentence(errors, model.effort)]
    told = {"unit": model.effort, **asdict(errors), "lost": errors.lost}
    kept = {name: told[name] for name in told}
    made = {**made, "check.json": json.dumps(kept, indent=2, ensure_ascii=False) + "\n"}
    if (line := warning(errors)) == "":
        return made, said
    return {name: _first(line, name, text) for name, text in made.items()}, [line, *said]


def _first(line: str, name: str, text: str) -> str:
    """A file that says something in its first line."""
    before, after = COMMENTS.get(Path(name).suffix, ("", ""))
    if Path(name).suffix == ".json":
        told = json.dumps({"warning": line, **json.loads(text)}, indent=2, ensure_ascii=False)
        return told.replace("{\n  ", "{", 1) + "\n"
    return f"{before}{line}{after}\n{text}"
