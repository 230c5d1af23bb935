"""Every effect that the diagnosis knows, so that a reader can judge what it might have said."""

from itertools import groupby
from typing import Any

from spirob.effects import all_effects
from spirob.report.data import ReportData
from spirob.report.effect_card import card
from spirob.report.sections import Section

PLACES = ("motor", "winch", "tendon", "body", "sensing")  # along the machine; others follow


class Library(Section):
    """All effects by place, each with its law, its numbers and what tells it from others."""

    order = 80
    title = "Library"
    template = "library.html.j2"
    pages = ("arm", "rig")

    def get_context(self, data: ReportData) -> dict[str, Any]:
        cards = sorted((card(effect) for effect in all_effects().values()), key=_along)
        places = [(place, list(group)) for place, group in groupby(cards, lambda c: c["place"])]
        return {
            "count": len(cards),
            "places": places,
            "named": {effect["name"] for effect in data.diagnosis["effects"]},
        }


def _along(about: dict[str, Any]) -> tuple[int, str, str]:
    place = about["place"]
    return PLACES.index(place) if place in PLACES else len(PLACES), place, about["name"]
