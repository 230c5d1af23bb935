"""Diagnoses a simulated rig and says whether the verdict is right."""

from pathlib import Path
from typing import Any

from spirob.machine.diagnosis import diagnose_recordings
from spirob.machine.recording import prepare
from spirob.machine.rig import RigFile
from tests.machine.rigs import Case


def diagnosed(case: Case, folder: Path) -> dict[str, Any]:
    """The document of a case's diagnosis."""
    for name, text in case.files.items():
        (folder / name).write_text(text)
    rig = RigFile.model_validate(case.rig)
    train = [prepare(f"train_{k}", trial, rig) for k, trial in enumerate(case.train)]
    return diagnose_recordings(rig, folder, train, [prepare("test", case.test, rig)]).document


def is_right(case: Case, document: dict[str, Any]) -> bool:
    """Right verdict, every hidden effect named (or a declared equivalent), and nothing besides."""
    named = [{e["name"], *e["equivalents"]} for e in document["effects"]]
    if document["verdict"] not in case.verdicts or len(named) != len(case.must):
        return False
    return all(any(names & wanted for names in named) for wanted in case.must)
