"""What the page shows of a rig's models: measured and modelled effort, and the fitted numbers."""

from typing import Any

import pandas as pd

from spirob.identify.fit import Fit
from spirob.machine.models import Model
from spirob.machine.search import Search


def overlay(search: Search, base: Fit, named: Fit) -> pd.DataFrame:
    """Rows of both roles: trial, role, time, position, measured, base, named."""
    parts = []
    for role, problem in (("test", search.heldout), ("train", search.train)):
        lines = {"base": problem(base.changes), "named": problem(named.changes)}
        measured, at = problem.measured(), 0
        for stretch in problem.stretches():
            rows = slice(at, at + len(stretch.seconds))
            at = rows.stop
            columns: dict[str, Any] = {"trial": stretch.trial, "role": role}
            columns |= {"time": stretch.seconds, "position": stretch.position}
            columns |= {"measured": measured[rows]}
            columns |= {name: measured[rows] + line[rows] for name, line in lines.items()}
            parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True)


def laws(search: Search, model: Model) -> pd.DataFrame:
    """Rows of held-out samples for each effect of the model: effect, the signals, shown and law.

    All other numbers as fitted,  shown = measured − without,  law = with − without,  in the unit
    of the effort; position and velocity in that of the axis, which is named.
    """
    problem, changes = search.heldout, model.fit.changes
    signals, measured = problem.signals(), problem.measured()
    held, parts = problem(changes), []
    for effect in model.effects:
        absent = {f"{effect.name()}.{n}": v for n, v in effect.neutral.items()}
        without = problem({**changes, **absent})
        columns: dict[str, Any] = {"effect": effect.name(), "time": signals["time"]}
        columns |= {"axis": problem.sizes.axis_unit}
        columns |= {"position": signals["position"], "velocity": signals["speed"]}
        columns |= {"effort": measured, "shown": -without, "law": held - without}
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame({"effect": []})


def parameters(search: Search, fit: Fit) -> dict[str, Any]:
    """Fitted numbers of a model, with their bounds."""
    about = search.train.table.about
    return {
        name.removeprefix("rig."): {
            "value": e.value,
            "low": e.low,
            "high": e.high,
            "unit": e.unit,
            "nominal": about[name].nominal,
            "bound_low": about[name].low,
            "bound_high": about[name].high,
            "at_bound": e.at_bound,
            "meaning": about[name].meaning,
        }
        for name, e in fit.estimates.items()
    }
