"""How often, how soon and how wrongly contacts are told, along the arm and by how it presses."""

from collections.abc import Mapping, Sequence
from typing import Any

from spirob.report import figures
from spirob.report.data import ReportData
from spirob.report.figures import DOMAINS, THRESHOLDS, WITHIN, Plot
from spirob.report.sections import Section
from spirob.report.words import MISSING, fixed, percent

SIGNALS = {"current": "raw current", "filtered": "100-sample mean"}


class Contacts(Section):
    """The detector with the paper's thresholds and with tuned ones, in simulation and on robot."""

    order = 57
    title = "Contact detector"
    template = "contacts.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        found = data.contacts or {}
        signals = {key: found[key] for key in SIGNALS if key in found}
        return {
            "counts": _counts(signals),
            "scales": {SIGNALS[key]: fixed(one["tuned_scale"], 2) for key, one in signals.items()},
            "rows": [row for key, one in signals.items() for row in rows(SIGNALS[key], one)],
            "curves": [_curve(key, one) for key, one in signals.items()],
            "along": [pair for key, one in signals.items() for pair in _along(key, one)],
            "tables": [_table(key, one) for key, one in signals.items() if _in_parts(one)],
            "columns": [f"{DOMAINS[d][0]}, {THRESHOLDS[t][0]}" for d, t in _sides()],
            "reason": data.absent.get("contacts", ""),
        }


def rows(name: str, signal: Mapping[str, Any]) -> list[dict[str, Any]]:
    """A row for each domain and thresholds: shares told, delays and false alarms."""
    out = []
    for rules, (how, *_) in THRESHOLDS.items():
        for domain, (where, _) in DOMAINS.items():
            one = signal[domain][rules]
            median, late = one["delay"] or (None, None)
            cells = [percent(one["ever"]), *(percent(share) for share in one["hits"].values())]
            cells += [fixed(median, 0), fixed(late, 0), fixed(one["alarms"], 2)]
            out.append({"signal": name, "thresholds": how, "where": where, "cells": cells})
    return out


def _counts(signals: Mapping[str, Any]) -> dict[str, str]:
    if not signals:
        return {}
    one = next(iter(signals.values()))
    return {domain: fixed(one[domain]["paper"]["contacts"], 0) for domain in DOMAINS}


def _curve(key: str, signal: Mapping[str, Any]) -> Plot:
    label = f"{SIGNALS[key].capitalize()}: contacts told in time, over false alarms"
    return Plot(f"contacts-roc-{key}", label, figures.roc(signal))


def _along(key: str, signal: Mapping[str, Any]) -> list[Plot]:
    if not _in_parts(signal):
        return []
    hits, delay = figures.hits_along(signal), figures.delay_along(signal)
    name = SIGNALS[key].capitalize()
    return [
        Plot(f"contacts-hits-{key}", f"{name}: contacts told in time, along the arm", hits),
        Plot(f"contacts-delay-{key}", f"{name}: delay of the decision, along the arm", delay),
    ]


def _in_parts(signal: Mapping[str, Any]) -> bool:
    return all("by_place" in signal[domain][rules] for domain, rules in _sides())


def _sides() -> list[tuple[str, str]]:
    return [(domain, rules) for domain in DOMAINS for rules in THRESHOLDS]


def _table(key: str, signal: Mapping[str, Any]) -> dict[str, Any]:
    """Hits and delays by gap and by motion, a column for each domain and thresholds."""
    found = {}
    for cut, said in (("by_gap", _gap), ("by_motion", _motion)):
        sides = [signal[domain][rules][cut] for domain, rules in _sides()]
        for parts in zip(*sides, strict=True):
            found[said(parts[0])] = [_cell(part) for part in parts]
    return {"signal": SIGNALS[key], "lines": found}


def _gap(part: Mapping[str, Any]) -> str:
    return f"gap of {fixed(1e3 * part['gap'], 0)} mm"


def _motion(part: Mapping[str, Any]) -> str:
    return f"{fixed(1e3 * part['speed'], 0)} mm/s against {fixed(part['load'], 2)} A"


def _cell(part: Mapping[str, Any]) -> str:
    if not part["contacts"]:
        return MISSING
    delay: Sequence[float] = part["delay"] or ()
    share = f"{percent(part['hits'][WITHIN])} of {fixed(part['contacts'], 0)}"
    return f"{share}, {fixed(delay[0], 0)} ms" if delay else share
