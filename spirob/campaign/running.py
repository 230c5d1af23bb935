"""Cases diagnosed blind, many in parallel, into one file with a line for each.

A line holds the figures from which a calibration can learn.
"""

import tempfile
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from joblib import delayed

from spirob import __version__
from spirob.campaign import results, true_law
from spirob.campaign.case import Case, drawn
from spirob.campaign.results import Line
from spirob.campaign.scoring import outcome
from spirob.errors import SpirobError
from spirob.files import write_text
from spirob.machine.axis import diagnose_recordings
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.recording import Recording, prepare
from spirob.machine.recordings.selection import filtered_alike

CLOSE = 1.1  # times the error of the chosen model: candidates within it are near rivals


def said(document: Mapping[str, Any]) -> dict[str, Any]:
    """The verdict and its names."""
    return {
        "verdict": document["verdict"],
        "effects": [
            {
                "name": e["name"],
                "probability": e["probability"],
                "equivalents": e["equivalents"],
                "rivals": e["rivals"],
            }
            for e in document["effects"]
        ],
        "sentence": document["sentence"],
    }


def features(document: Mapping[str, Any]) -> dict[str, Any]:
    """Figures of the search, with or without a name at its end.

    chosen      effects of the model that the search stands by, whatever the verdict
    evidence    what says the same as each, what is a rival, and the figures of `certainty`
    stated      probability of the least sure of them; of the first candidate where none is named
    gain        fall of the squared held-out error beside the best model with another effect
    taken       fall of the squared held-out error beside the bare model;  taken_train  of fitted
    remaining   held-out error over the effort's RMS
    ceiling     share of the squared error left that still follows from the motion
    numbers     of the rig and the named effects;  at_bound  those that ended at a bound
    close       candidates that are not chosen, within a tenth of the held-out error
    considered  all that were screened
    delay       [s], fitted; null where it was not
    """
    rungs = [r for r in document["ladder"] if not r.get("ceiling")]
    bare, chosen = rungs[0], rungs[-1]
    names = chosen["effects"]
    error = chosen["test"]["rmse"]
    others = [
        c["heldout_rmse"]
        for c in document["candidates"]
        if c["name"] not in names and c["heldout_rmse"] is not None
    ]
    fitted = [*document["numbers"].values()]
    fitted += [n for e in document["effects"] for n in e["parameters"].values()]
    stated = [e["probability"] for e in document["effects"]]
    stated = stated or [c["probability"] for c in document["candidates"][:1]]
    return {
        "chosen": names,
        "evidence": document["evidence"],
        "stated": min(stated, default=None),
        "gain": 1.0 - (error / min(others)) ** 2 if others and min(others) > 0 else None,
        "taken": _fall(bare["test"]["rmse"], error),
        "taken_train": _fall(bare["train"]["rmse"], chosen["train"]["rmse"]),
        "remaining": error / document["effort_rms"]["test"],
        "remaining_train": chosen["train"]["rmse"] / document["effort_rms"]["train"],
        "noise": document["noise_floor"] / document["effort_rms"]["train"],
        "ceiling": document["left"]["share"],
        "numbers": len(fitted),
        "at_bound": sum(_at_bound(n) for n in fitted),
        "close": sum(rmse <= CLOSE * error for rmse in others),
        "considered": len(document["candidates"]),
        "delay": document["numbers"].get("delay", {}).get("value"),
        "notes": len(document["repairs"]),
    }


def law(document: Mapping[str, Any]) -> dict[str, Any] | None:
    """What a composed law is, None where there is none."""
    found = document["composed"]
    if found is None:
        return None
    kept = {key: found[key] for key in ("shape", "formula", "terms", "share", "dissipative")}
    return kept | {"numbers": len(found["numbers"]), "nearest": found["nearest"]}


def errors(document: Mapping[str, Any], least: float | None) -> dict[str, float | None]:
    """Held-out RMSE over that of the effort, by what the model holds.

    bare   the fitted numbers alone;  said  with the named effects, where there are any
    law    with the composed law besides, null where there is none
    true   with nothing hidden (`least`), which is what knowing the law leaves
    """
    size = document["effort_rms"]["test"]
    rungs = [r["test"]["rmse"] for r in document["ladder"] if not r.get("ceiling")]
    named, found = bool(document["effects"]), document["composed"]
    return {
        "bare": rungs[0] / size,
        "said": rungs[-1 if named else 0] / size,
        "law": None if found is None else found["rmse"]["test"] / size,
        "true": None if least is None else least / size,
    }


def _fall(before: float, after: float) -> float | None:
    return 1.0 - (after / before) ** 2 if before > 0 else None


def _at_bound(number: Mapping[str, Any]) -> bool:
    """An interval is cut to the bounds of its number, so at one of them it ends at the value."""
    return number["low"] != number["high"] and number["value"] in (number["low"], number["high"])


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
        "disturbed": case.disturbed,
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
    except Exception as error:
        found["crashed"] = _told(error)
    found["seconds"] = round(time.process_time() - begun, 3)
    return found | {"outcome": outcome(found)}


def _told(error: Exception) -> str:
    """A bug and where it was, a line for each of the last three places, without folders."""
    places = traceback.extract_tb(error.__traceback__, limit=-3)
    where = [f"{Path(p.filename).name}:{p.lineno}, in {p.name}" for p in places]
    return "\n".join([*where, f"{type(error).__name__}: {error}"])


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

    def read(k: int, cutoff: float | None) -> Recording:
        return prepare(f"log_{k}", logs[k], rig, cutoff=cutoff)

    last = len(logs) - 1
    train, test = filtered_alike(read, range(last), [last])
    return diagnose_recordings(rig, folder, train, test, without=lacking).document


def known(path: Path) -> dict[str, Line]:
    """The results of a file by the name of their case; see `results.read`."""
    return {_name(one): one for one in results.read(path, "campaign", _name)}


def _name(one: Line) -> str:
    further = (bool(one.get(flag)) for flag in ("without", "disturbed"))
    return Case(one["simulator"], one["kind"], one["seed"], *further).name


def play(
    chosen: Sequence[Case],
    path: Path,
    workers: int,
    tell: Callable[[Case, Line], None] = lambda case, line: None,
) -> list[Line]:
    """Play the cases that have no result in the file yet; all results in the order of `chosen`."""
    found = known(path)

    def left() -> list[Case]:
        return [case for case in chosen if case.name not in found]

    def done(case: Case, lines: list[Line], which: str) -> None:
        found[case.name] = lines[0]
        tell(case, lines[0])

    if left():
        write_text(path, results.text(list(found.values())))  # without a torn end
    results.play(left, delayed(_one), path, workers, done)
    return [found[case.name] for case in chosen]


def _one(case: Case) -> tuple[Case, list[Line]]:
    return case, [result(case)]
