"""Diagnoses a simulated rig and says whether the verdict is right.

`test_verdicts` searches the whole library; a test of what logs hold, or of a number, needs no more
than one effect of each kind to go astray with.
"""

from collections.abc import Collection
from pathlib import Path
from typing import Any

from spirob.effects import all_effects
from spirob.machine.axis import diagnose_recordings
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.recording import prepare
from tests.machine.rigs import Case

FEW = {
    "asymmetric_viscous_friction",
    "cogging",
    "constant_force",
    "coulomb_friction",
    "current_offset",
    "gear_compliance",
    "load_dependent_friction",
    "presliding_friction",
    "quadratic_drag",
    "tip_payload",
}
OTHERS = frozenset(all_effects()) - FEW  # are no candidates where a test says so


def diagnosed(case: Case, folder: Path, without: Collection[str] = ()) -> dict[str, Any]:
    """The document of a case's diagnosis, with all effects but some as candidates."""
    for name, text in case.files.items():
        (folder / name).write_text(text)
    rig = RigFile.model_validate(case.rig)
    train = [prepare(f"train_{k}", trial, rig) for k, trial in enumerate(case.train)]
    test = [prepare("test", case.test, rig)]
    return diagnose_recordings(rig, folder, train, test, without=without).document


def is_right(case: Case, document: dict[str, Any]) -> bool:
    """Right verdict, every hidden effect named (or a declared equivalent), and nothing besides.

    A hidden effect that is richer than the library's may be named by several of its group: bristle
    friction with a Stribeck curve is presliding friction and Stribeck friction.  Undecided between
    such a group alone is right, too.
    """
    asked = [{e["name"], *e["equivalents"], *e["rivals"]} for e in document["effects"]]
    within = all(any(names <= wanted for wanted in case.must) for names in asked)
    named = [{e["name"], *e["equivalents"]} for e in document["effects"]]
    told = "named" if document["verdict"] == "undecided" and within else document["verdict"]
    if told not in case.verdicts:
        return False
    found = all(any(names & wanted for names in named) for wanted in case.must)
    return found and all(any(names & wanted for wanted in case.must) for names in named)
