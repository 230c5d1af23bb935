"""The first screen: the verdict, how much it explains, the arm in motion or a rig's ladder."""

import base64
import math
from typing import Any

import numpy as np

from spirob.report import arm
from spirob.report.data import ReportData
from spirob.report.sections import Section
from spirob.report.sections.ladder import ladder_plot
from spirob.report.sections.repairs import each_once
from spirob.report.words import EFFORT, column, fixed, is_number, percent

KINDS = {
    "named": "A missing effect is named",
    "undecided": "These data cannot decide",
    "nothing_missing": "Nothing is missing",
    "unknown": "Something is missing that no name is likely enough for",
}
NOT_ASKED = "No video was asked for; spirob report --video renders one where OpenGL works."
FEW = 5.0  # per cent; where less is missing, decimals are of use


class Verdict(Section):
    """Two sentences, the ladder of errors and the model's arm."""

    order = 10
    title = "Verdict"
    template = "verdict.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        diagnosis = data.diagnosis
        return told(diagnosis) | {
            "asked": asked_sentence(diagnosis),
            "proof": proof_sentence(diagnosis),
            "explained": explained_sentence(diagnosis["ladder"], diagnosis["unit"]),
            "arm": None
            if data.motion is None
            else arm.payload(data.motion, data.posture, data.geometry),
            "clip": None if data.clip is None else base64.b64encode(data.clip).decode("ascii"),
            "no_clip": data.absent.get("clip", NOT_ASKED),
            "no_arm": data.absent.get("motion", ""),
            "no_robot": data.absent.get("posture", ""),
            "apart": apart_sentence(data),
            "score": data.score,
        }


def told(diagnosis: dict[str, Any]) -> dict[str, Any]:
    """What the first screen says of the arm as of any rig."""
    unit, rungs = diagnosis["unit"], diagnosis["ladder"]
    noise_floor = diagnosis.get("noise_floor")
    return {
        "kind": kind(diagnosis),
        "sentence": diagnosis["sentence"],
        "gain": gain_sentence(rungs, noise_floor, unit),
        "floor": floor_sentence(diagnosis),
        "ladder": ladder_plot(rungs, noise_floor, unit),
    }


def kind(diagnosis: dict[str, Any]) -> str:
    """What sort of verdict it is and, where an effect is named, how sure."""
    found = KINDS.get(diagnosis["verdict"], diagnosis["verdict"])
    effects = diagnosis.get("effects") or []
    if diagnosis.get("doubts"):
        return "Look at the data first"
    if diagnosis["verdict"] == "undecided":
        known = [e["together"] for e in effects if is_number(e.get("together"))]
        return f"{found}; {percent(min(known))} sure that it is one of these" if known else found
    if diagnosis["verdict"] != "named":
        return found
    sure = [e for e in effects if is_number(e.get("probability"))]
    if len(sure) > 1:
        each = ", ".join(f"{e['name'].replace('_', ' ')} {percent(e['probability'])}" for e in sure)
        return f"Missing effects are named; sure of {each}"
    return f"{found}; {percent(sure[0]['probability'])} sure" if sure else found


def asked_sentence(diagnosis: dict[str, Any]) -> str:
    """Which further trials were played to decide, and what was said before them; or empty."""
    asked = diagnosis.get("asked")
    if not asked:
        return ""
    if asked.get("aside"):
        return (
            f"To decide, '{asked['experiment']}' was played on either side. It does not tell which "
            "of those in question it is, and the verdict stands."
        )
    return (
        f"Decided with '{asked['experiment']}', played on either side. Before it: {asked['before']}"
    )


def proof_sentence(diagnosis: dict[str, Any]) -> str:
    """What a trial of its own said of the name; empty where none was played."""
    proof = diagnosis.get("proof")
    if not proof:
        return ""
    told = "the name holds" if proof["holds"] else "too little for a name"
    return (
        f"Put to the proof with '{proof['experiment']}', a trial of its own: it accounts for "
        f"{percent(max(proof['share'], 0.0))} of the squared error there; {told}."
    )


def floor_sentence(diagnosis: dict[str, Any]) -> str:
    """What counts as an effect, and why; empty where no floor was measured."""
    floor = diagnosis.get("floor")
    if not floor:
        return ""
    return f"The least that counts as an effect is {percent(floor['share'])}: {floor['reason']}"


def gain_sentence(rungs: list[dict[str, Any]], noise_floor: float | None, unit: str) -> str:
    """The second sentence: what the named effects take off the held-out error."""
    if not rungs or not is_number(before := heldout(rungs[0])):
        return "No held-out error was recorded."
    effort = EFFORT.get(unit, "effort")
    # the first with most effects: a flexible residual on top of them is a ceiling, not a model
    grown = max(rungs, key=lambda rung: len(rung.get("effects") or ()))
    after = heldout(grown) if grown.get("effects") else None
    numbers, (noise,) = column([before, after, noise_floor], 2), column([noise_floor], 2)
    floor = f"; sensor noise alone is {noise} {unit}" if is_number(noise_floor) else ""
    if after is None or not is_number(after) or before <= 0:
        return f"On held-out trials the base model's {effort} is off by {numbers[0]} {unit}{floor}."
    if after < before:
        change = f"falls from {numbers[0]} to {numbers[1]} {unit}, by {percent(1 - after / before)}"
    else:
        change = f"does not fall ({numbers[0]} before, {numbers[1]} {unit} after)"
    return f"On held-out trials the RMSE of {effort} {change}{floor}."


def explained_sentence(rungs: list[dict[str, Any]], unit: str) -> str:
    """How much of the effort's variance the model explains, without and with the named effects."""
    if not rungs or not is_number(before := (rungs[0].get("heldout") or {}).get("r2")):
        return ""
    effort = EFFORT.get(unit, "effort")
    sentence = f"The fitted model explains {share(before)} of the {effort} that it has not seen"
    grown = max(rungs, key=lambda rung: len(rung.get("effects") or ()))
    after = (grown.get("heldout") or {}).get("r2") if grown.get("effects") else None
    return f"{sentence}; with the effect {share(after)}." if is_number(after) else f"{sentence}."


def share(r2: float) -> str:
    """R² in per cent, with as many decimals as show what is missing to all of it."""
    value = 100 * max(r2, 0.0)
    missing = 100 - value
    if missing >= FEW or missing < 1e-4:
        return f"{fixed(value, 0)} %"
    decimals = min(4, max(1, -math.floor(math.log10(missing))))
    return f"{fixed(value, decimals)} %"


def apart_sentence(data: ReportData) -> str:
    """How far the tips of robot and model are apart; empty where one of them is not known."""
    if data.motion is None or data.posture is None:
        return ""
    distances = 1e3 * arm.apart(data.motion, data.posture, data.geometry)
    if not len(distances):
        return ""
    middle, most = (f"{value:.0f}" for value in (np.median(distances), distances.max()))
    return f"Their tips are {middle} mm apart in the median and {most} mm at most."


def heldout(rung: dict[str, Any]) -> float | None:
    """Held-out RMSE of a rung, if it has one."""
    return (rung.get("heldout") or {}).get("rmse")


class RigVerdict(Section):
    """Verdict of a rig's diagnosis; there is no arm to be shown."""

    order = 10
    title = "Verdict"
    template = "rig_verdict.html.j2"
    pages = ("rig",)

    def get_context(self, data: ReportData) -> dict[str, Any]:
        diagnosis = data.diagnosis
        return told(diagnosis) | {
            "explanation": diagnosis["explanation"],
            "repairs": each_once(diagnosis["repairs"]),
        }
