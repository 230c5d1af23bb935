"""From a diagnosis on disk to files of a target, each whole or not at all, and the proof of them.

The held-out logs are played in what was written, in a process that cannot import us.
"""

import json
import shutil
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from spirob.errors import ExportError
from spirob.export import targets
from spirob.export.arm import CorrectedArm, corrected_arm
from spirob.export.axis import equations
from spirob.export.body import AXIS
from spirob.export.code import c_name
from spirob.export.corrected import Corrected, corrected, read_document
from spirob.export.heldout import PLAYED, Errors, Heldout, played_arm, there
from spirob.export.targets import played_alone
from spirob.files import may_hold_results, write_text

LOSS = 0.01  # of the effects' size, which an export may lose in silence


def played(model: Corrected, to: str, folder: Path, heldout: Heldout | None = None) -> Errors:
    """The errors of a model that was exported to a folder for a target, on the held-out logs.

    Raises ExportError where it cannot be played, with what the target's `play` says.
    """
    heldout = heldout or Heldout(model)
    made = played_alone(to, folder, about_of(model, to), heldout.given())
    return heldout.errors(made["effort"], made["framed"])


def about_of(model: Corrected, to: str) -> dict[str, Any]:
    """What a target's `play` is told beside the rows."""
    return {
        "name": c_name(model.name),
        "fields": list(equations(model).state),
        "joint": model.body.joint if model.body else AXIS,
        "others": list(model.body.others) if model.body else [],
        "controller": to == "mujoco",
    }


def sentence(errors: Errors, unit: str) -> str:
    """Both errors side by side."""
    return (
        f"held-out error {errors.exported:.4g} {unit} exported, {errors.ours:.4g} {unit} here; "
        f"apart {errors.apart:.3g} {unit}, {percent(errors)}"
    )


def percent(errors: Errors) -> str:
    """What is lost, in words."""
    return f"{100 * errors.lost:.2g} % of the effects' size ({errors.size:.3g})"


def warning(errors: Errors) -> str:
    """The first line of an export that loses more than a per cent; empty for others."""
    if errors.lost <= LOSS:
        return ""
    return f"LOSES {percent(errors)} against the diagnosis, measured on its held-out logs"


ONE_WAY = (
    "ONE WAY: fitted to logs in which the axis moves one way only, where dry friction and a "
    "constant force are the same; for motions of this way alone"
)
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
    may_hold_results(out)
    target, document = known[to], read_document(path)
    model = _model(document, path.parent)
    if isinstance(model, CorrectedArm):
        if not hasattr(target, "arm"):
            raise ExportError(f"'{to}' holds no arm: it has {target.LACKS}")
        made, plays = target.arm(model), to in PLAYED
    else:
        by_tendon = model.body is not None and model.body.tendon
        made = target.files(model)
        plays = hasattr(target, "play") and not (by_tendon and to in ("mujoco", "mjcf"))
    if check and not plays:
        raise ExportError(f"'{to}' leaves nothing here that could be played; leave --check away")
    said: list[str] = []
    if plays and (check or (target.LOSSY and _kept(model))):
        made, said = _proved(model, to, made)
    if isinstance(model, Corrected) and model.way:
        made = {name: _first(ONE_WAY, name, text) for name, text in made.items()}
        said.insert(0, ONE_WAY)
    _write(out, made)
    return Exported(tuple(out / name for name in made), tuple(said))


def _write(out: Path, made: dict[str, str]) -> None:
    """Write all files, or none: all are whole before the first gets its place."""
    fresh = not out.exists()
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out, prefix=".") as place:
        try:
            for name, text in made.items():
                write_text(Path(place) / name, text)
        except OSError:
            if fresh:
                shutil.rmtree(out, ignore_errors=True)
            raise
        for name in made:
            (Path(place) / name).replace(out / name)


def _kept(model: Corrected | CorrectedArm) -> bool:
    """Whether there are logs that were held out."""
    if isinstance(model, Corrected):
        return there(model.folder)
    try:
        return bool(model.trials())
    except ExportError:
        return False


def _model(document: dict[str, Any], folder: Path) -> Corrected | CorrectedArm:
    told = document.get("model")
    of_arm = isinstance(told, dict) and told.get("machine") == "arm"
    if of_arm or "rig" not in document:
        return corrected_arm(document, folder)
    return corrected(document, folder)


def _proved(
    model: Corrected | CorrectedArm, to: str, made: dict[str, str]
) -> tuple[dict[str, str], list[str]]:
    """The files, each with what it loses in its first line, and what the proof says."""
    with tempfile.TemporaryDirectory() as place:
        for name, text in made.items():
            write_text(Path(place) / name, text)
        if isinstance(model, CorrectedArm):
            errors, unit = played_arm(model, to, Path(place)), "A"
        else:
            errors, unit = played(model, to, Path(place)), model.effort
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
        read = json.loads(text)
        lines = "; ".join(t for t in (line, read.pop("warning", "")) if t)
        told = json.dumps({"warning": lines, **read}, indent=2, ensure_ascii=False)
        return told.replace("{\n  ", "{", 1) + "\n"
    return f"{before}{line}{after}\n{text}"
