"""A law for what the library lacks, composed where no name explains what is left.

Written beside the diagnosis: `law.py`, an effect like any other, and composed.parquet, its drawing.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pipeline.diagnose import settings_of
from pipeline.model import plant, residual
from pipeline.overlay import write_table
from pipeline.schema import Config
from pipeline.stage import read_json, tell
from spirob.diagnosis.document import CEILING
from spirob.logs.atomic import write_text
from spirob.machine.composed.arm import composed_for_arm

ROLES = ("train", "validate", "heldout")


def composed(
    root: Path, config: Config, folder: Path, told: Mapping[str, Any], changes: Mapping[str, float]
) -> dict[str, Any] | None:
    """What the document says of the law, None where none holds.

    told  the diagnosis that stands;  changes  numbers of its model
    """
    model = plant(config)
    own = {role: residual(root, config, model, role) for role in ROLES}
    fitted = read_json(root / "data/identified/base.json", "identify")["parameters"]
    names = [name for name in fitted if name not in told["vague"]]
    best = _least(told["ladder"])
    law = composed_for_arm(own, names, changes, best, settings_of(config), tell)
    if law is None:
        tell("no law of a few terms takes what is left")
        return None
    write_text(root / folder / law.document["file"], law.text)
    write_table(root / folder / "composed.parquet", law.drawing)
    tell(law.document["sentence"])
    return law.document


def _least(ladder: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """RMSE by role of the best that the search found."""
    rungs = [rung for rung in ladder if rung["label"] != CEILING]
    best = min(rungs, key=lambda rung: float(rung["validate"]["rmse"]))
    return {role: float(best[role]["rmse"]) for role in ROLES}
