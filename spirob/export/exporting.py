"""From a diagnosis on disk to files of a target, each whole or not at all."""

import json
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from spirob.errors import ExportError
from spirob.export import targets
from spirob.export.arm import CorrectedArm, corrected_arm
from spirob.export.checking import played, played_arm, sentence, warning
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
    target, document = known[to], read_document(path)
    model = _model(document, path.parent)
    if isinstance(model, CorrectedArm):
        if not hasattr(target, "arm"):
            raise ExportError(f"'{to}' holds no arm: it has {target.LACKS}")
        made, player = target.arm(model), "arm" if target.PLAYER == "mujoco" else ""
    else:
        by_tendon = model.body is not None and model.body.tendon
        made = target.files(model)
        player = "" if by_tendon and target.PLAYER in ("mujoco", "mjcf") else target.PLAYER
    if check and not player:
        raise ExportError(f"'{to}' leaves nothing here that could be played; leave --check away")
    said: list[str] = []
    if player and (check or (target.LOSSY and there(path.parent))):
        made, said = _proved(model, player, made)
    for name, text in made.items():
        write_text(out / name, text)
    return Exported(tuple(out / name for name in made), tuple(said))


def _model(document: dict[str, Any], folder: Path) -> Corrected | CorrectedArm:
    told = document.get("model")
    of_arm = isinstance(told, dict) and told.get("machine") == "arm"
    if of_arm or "rig" not in document:
        return corrected_arm(document, folder)
    return corrected(document, folder)


def _proved(
    model: Corrected | CorrectedArm, player: str, made: dict[str, str]
) -> tuple[dict[str, str], list[str]]:
    """The files, each with what it loses in its first line, and what the proof says."""
    with tempfile.TemporaryDirectory() as place:
        for name, text in made.items():
            write_text(Path(place) / name, text)
        if isinstance(model, CorrectedArm):
            errors, unit = played_arm(model, Path(place)), "A"
        else:
            errors, unit = played(model, player, Path(place)), model.effort
    told = {"unit": unit, **asdict(errors), "lost": errors.lost}
    made = {**made, "check.json": json.dumps(told, indent=2, ensure_ascii=False) + "\n"}
    said = [sentence(errors, unit)]
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
