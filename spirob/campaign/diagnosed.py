"""A case diagnosed blind: the diagnosis gets a description and columns, nothing else."""

import tempfile
import time
import traceback
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from spirob import __version__
from spirob.campaign import true_law
from spirob.campaign.case import Case, drawn
from spirob.campaign.features import errors, features, law, said
from spirob.campaign.scoring import outcome
from spirob.errors import SpirobError
from spirob.machine.axis import diagnose_recordings
from spirob.machine.recording import prepare
from spirob.machine.rig import RigFile


def result(case: Case) -> dict[str, Any]:
    """What was hidden, what was said of it, whether that is right, and how it looked inside.

    A log or description that is refused is a result, too: `refused` holds the sentence.  So is a
    bug of ours, which must not end the cases beside it: `crashed` holds where it was.
    """
    made = drawn(case)
    found: dict[str, Any] = {
        "simulator": case.simulator,
        "kind": case.kind,
        "seed": case.seed,
        "without": case.without,
        "release": __version__,
        "truth": made.truth,
        "about": made.about,
        "refused": "",
        "crashed": "",
        "said": None,
        "features": None,
        "composed": None,
        "heldout": None,
    }
    begun = time.process_time()
    try:
        with tempfile.TemporaryDirectory(prefix="spirob-campaign-") as folder:
            lacking = _lacking(made.truth) if case.without else []
            logs = [*made.train, made.test]
            document = _diagnosed(made.rig, made.files, logs, Path(folder), lacking)
            least = true_law.least(made, Path(folder)) if made.truth["hidden"] else None
        found |= {"said": said(document), "features": features(document)}
        found |= {"composed": law(document), "heldout": errors(document, least)}
    except SpirobError as error:
        found["refused"] = str(error)
    except Exception:
        found["crashed"] = traceback.format_exc(limit=-3)
    found["seconds"] = round(time.process_time() - begun, 3)
    return found | {"outcome": outcome(found)}


def _lacking(truth: Mapping[str, Any]) -> list[str]:
    """The effects that are what is hidden, or a part of it."""
    right = [name for names in truth["must"] for name in names]
    return sorted({*right, *truth["besides"], *truth["near"]})


def _diagnosed(
    plain: dict[str, Any],
    files: dict[str, str],
    logs: list[dict[str, Any]],
    folder: Path,
    lacking: Sequence[str],
) -> dict[str, Any]:
    """The document of a diagnosis; the last log is held out."""
    for name, text in files.items():
        (folder / name).write_text(text)
    rig = RigFile.model_validate(plain)
    read = [prepare(f"log_{k}", columns, rig) for k, columns in enumerate(logs)]
    return diagnose_recordings(rig, folder, read[:-1], read[-1:], without=lacking).document
