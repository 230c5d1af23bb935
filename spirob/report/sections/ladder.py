"""Which effect it is: candidates, the steps from base model to noise, fitted numbers."""

from typing import Any

from spirob.effects import all_effects
from spirob.report.data import ReportData
from spirob.report.effect_card import card
from spirob.report.ladder import ceiling_sentence, rows
from spirob.report.sections import Section
from spirob.report.words import column, interval, is_number, percent, unit_text

SPLITS = ("train", "left_out", "heldout")


class Ladder(Section):
    """The evidence behind the verdict, and what to measure next."""

    order = 40
    title = "Ladder and candidates"
    template = "ladder.html.j2"
    pages = ("arm", "rig")

    def get_context(self, data: ReportData) -> dict[str, Any]:
        diagnosis = data.diagnosis
        left = diagnosis.get("left") or {}
        chosen = {effect["name"] for effect in diagnosis["effects"]}
        return {
            "unit": diagnosis["unit"],
            "explanation": diagnosis.get("explanation", ""),
            "next_experiment": diagnosis.get("next_experiment", ""),
            "candidates": candidates(fitted(diagnosis), chosen),
            "screened": len(diagnosis["candidates"]) - len(fitted(diagnosis)),
            "rungs": rows(diagnosis["ladder"], diagnosis.get("noise_floor")),
            "ceiling": ceiling_sentence(diagnosis["ladder"], left.get("share")),
            "effects": [effect_entry(effect, declared(data)) for effect in diagnosis["effects"]],
        }


def declared(data: ReportData) -> dict[str, dict[str, Any]]:
    """What the library says of each named effect; a user's own file is not in it.

    Nor is the law of a plain axis, where the library's of that name acts on a tendon.
    """
    known = all_effects()
    titles = {effect["name"]: effect["title"] for effect in data.diagnosis["effects"]}
    named = {n: known[n] for n, title in titles.items() if n in known and known[n].title == title}
    return {name: card(effect) for name, effect in named.items()}


def fitted(diagnosis: dict[str, Any]) -> list[dict[str, Any]]:
    """The candidates that were fitted in full; the screening ended the others."""
    return [c for c in diagnosis["candidates"] if is_number(c.get("train_rmse"))]


def candidates(found: list[dict[str, Any]], chosen: set[str]) -> list[dict[str, Any]]:
    """Candidates as rows, most probable first."""
    found = sorted(found, key=lambda c: -(c.get("probability") or 0))
    errors = {key: column([c.get(f"{key}_rmse") for c in found]) for key in SPLITS}
    return [
        {
            "title": candidate["title"],
            "chosen": candidate["name"] in chosen,
            "share": candidate["probability"] if is_number(candidate.get("probability")) else 0,
            "probability": percent(candidate.get("probability")),
            "errors": [errors[key][k] for key in SPLITS],
            "gain": percent(candidate.get("screen_gain")),
        }
        for k, candidate in enumerate(found)
    ]


def effect_entry(effect: dict[str, Any], cards: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """A named effect with its law, its fitted numbers and what it cannot be told from."""
    about = cards.get(effect["name"])
    symbols = {number["name"]: number["symbol"] for number in about["numbers"]} if about else {}
    return {
        "title": effect["title"],
        "name": effect["name"],
        "about": about,
        "probability": percent(effect.get("probability")),
        "equivalents": effect.get("equivalents") or [],
        "parameters": [
            {
                "name": name.replace("_", " "),
                "symbol": symbols.get(name, ""),
                "unit": unit_text(fitted["unit"]),
                "texts": interval(fitted["value"], fitted.get("low"), fitted.get("high")),
            }
            for name, fitted in effect.get("parameters", {}).items()
        ],
    }
