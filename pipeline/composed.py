"""A law for what the library lacks, composed where no name explains what is left.

Written beside the diagnosis: `law.py`, an effect like any other, and composed.parquet, its drawing.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pipeline.model import plant, weighed_residuals
from pipeline.overlay import write_table
from pipeline.schema import Config
from pipeline.stage import read_json, tell
from spirob.diagnosis.criteria import Settings
from spirob.diagnosis.document import CEILING
from spirob.files import write_text
from spirob.machine.composed.arm import composed_for_arm

OUT = Path("data/diagnosis")
ROLES = ("train", "validate", "heldout")


def composed(
    root: Path,
    config: Config,
    settings: Settings,
    told: Mapping[str, Any],
    changes: Mapping[str, float],
) -> dict[str, Any] | None:
    """What the document says of the law, None where none holds.

    settings  with the floor of the machine
    told  the diagnosis that stands;  changes  numbers of its model
    """
    own = weighed_residuals(root, config, plant(config))
    fitted = read_json(root / "data/identified/base.json", "identify")["parameters"]
    names = [name for name in fitted if name not in told["vague"]]
    best = _least(told["ladder"])
    law = composed_for_arm(own, names, changes, best, settings, tell)
    if law is None:
        tell("no law of a few terms takes what is left")
        return None
    write_text(root / OUT / law.document["file"], law.text)
    write_table(root / OUT / "composed.parquet", law.drawing)
    tell(law.document["sentence"])
    return law.document


def _least(ladder: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """RMSE by role of the best that the search found."""
    rungs = [rung for rung in ladder if rung["label"] != CEILING]
    best = min(rungs, key=lambda rung: float(rung["validate"]["rmse"]))
    return {role: float(best[role]["rmse"]) for role in ROLES}
