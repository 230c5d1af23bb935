"""Each effect over the data: its fitted law, and what would tell it from its rivals."""

from typing import Any

import pandas as pd

from spirob.effects import all_effects
from spirob.report import laws
from spirob.report.data import ReportData
from spirob.report.figures import Plot
from spirob.report.laws import LOAD, PLACE, SPEED, TIME, Against, Law, against, law
from spirob.report.regimes import driven
from spirob.report.sections import Section
from spirob.report.words import column, is_number, percent


class Laws(Section):
    """For each named effect, or the leading candidates: law against residual, and the rivals."""

    order = 42
    title = "Effects over the data"
    template = "laws.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        if data.laws is None:
            return {"effects": [], "named": False, "reason": data.absent["laws"]}
        known, places = all_effects(), driven(data.compare)
        shown = []
        for name, played in data.laws.groupby("effect", sort=False, observed=True):
            found = law(played, data.overlay, places, known.get(str(name)))
            if found is not None:
                shown.append(entry(str(name), found, data))
        return {
            "effects": shown,
            "named": bool(data.diagnosis["effects"]),
            "reason": "No motor was driven in a trial that no fit has seen.",
        }


def entry(name: str, found: Law, data: ReportData) -> dict[str, Any]:
    """Texts and figures of one effect."""
    known = all_effects()
    titles = {c["name"]: c["title"] for c in data.diagnosis["candidates"]}
    title = titles.get(name) or (known[name].title if name in known else name.replace("_", " "))
    return {
        "name": name,
        "title": title,
        "sentence": sentence(found),
        "rivals": rivals(name, data),
        "plots": plots(name, title, found),
    }


def plots(name: str, title: str, found: Law) -> list[Plot]:
    """The two figures of an effect: over the signal that it depends on, and over its own law."""
    over = found.against.title.partition(" [")[0]
    return [
        Plot(
            f"law-{name}",
            f"Residual and fitted law of {title} over {over}",
            laws.over_signal(found),
        ),
        Plot(
            f"law-{name}-itself",
            f"Residual over the fitted law of {title}",
            laws.against_itself(found),
        ),
    ]


def sentence(found: Law) -> str:
    """How much of what the residual showed the law accounts for."""
    share = found.accounted
    if share <= 0:
        return "The law takes nothing off the squared residual of the trials that no fit has seen."
    return (
        f"The law accounts for {percent(share)} of the squared residual that is left without it, "
        "on trials that no fit has seen."
    )


def rivals(name: str, data: ReportData) -> list[dict[str, str]]:
    """The other candidates: what each leaves, and the experiment that would tell them apart."""
    known = all_effects()
    chosen = {effect["name"] for effect in data.diagnosis["effects"]} | {name}
    others = [
        c for c in data.diagnosis["candidates"] if c["name"] not in chosen and is_number(_milli(c))
    ]
    errors = column([_milli(c) for c in others])
    found = []
    for other, error in zip(others, errors, strict=True):
        rival = other["name"]
        ways = [
            known[a].tell_apart[b]
            for a, b in ((name, rival), (rival, name))
            if a in known and b in known[a].tell_apart
        ]
        test = ways[0] if ways else "the library holds no experiment for these two"
        found.append({"title": other["title"], "left": f"{error} mA", "test": test})
    return found


def _milli(candidate: dict[str, Any]) -> float | None:
    value = candidate.get("left_out_rmse")
    return 1e3 * value if is_number(value) else None


ABSENT = "Laws are drawn where an effect is named."


class RigLaws(Section):
    """For each named effect: law against residual over the signal that it depends on."""

    order = 42
    title = "Effects over the data"
    template = "laws.html.j2"
    pages = ("rig",)

    def get_context(self, data: ReportData) -> dict[str, Any]:
        named = {effect["name"]: effect["title"] for effect in data.diagnosis["effects"]}
        shown = []
        if data.laws is not None:
            for name, rows in data.laws.groupby("effect", sort=False):
                if name in named and rows["shown"].any():
                    shown.append(_entry(str(name), named[str(name)], law_of(rows, data.diagnosis)))
        return {"effects": shown, "named": True, "reason": ABSENT}


def law_of(rows: pd.DataFrame, diagnosis: dict[str, Any]) -> Law:
    """The samples of one effect, over the signal of the rig nearest to what it depends on."""
    axis, unit = rows["axis"].iloc[0], diagnosis["unit"]
    over = {
        SPEED: ("velocity", Against("velocity", f"speed [{axis}/s]")),
        PLACE: ("position", Against("position", f"position [{axis}]")),
        LOAD: ("effort", Against("effort", f"{diagnosis['effort']} [{unit}]")),
        TIME: ("time", Against("time", "time since the log began [s]")),
    }
    column, shown_over = over[against(all_effects().get(str(rows["effect"].iloc[0])))]
    x, seen, law = (rows[name].to_numpy(float) for name in (column, "shown", "law"))
    return Law(shown_over, x, seen, law, diagnosis["effort"], unit, 1.0)


def _entry(name: str, title: str, found: Law) -> dict[str, Any]:
    return {
        "title": title,
        "sentence": sentence(found),
        "rivals": [],
        "plots": plots(name, title, found),
    }
