"""What the page shows of a rig's models: measured and modelled effort, and the fitted numbers."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from spirob.diagnosis.screen import without
from spirob.effects import Effect
from spirob.identify.fit import Fit
from spirob.identify.problem import Problem
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


def laws(
    problem: Problem, effects: Sequence[type[Effect]], changes: Mapping[str, float], axis: str
) -> pd.DataFrame:
    """Rows of samples of the effort for each effect of a model: effect, signals, shown and law.

    problem  held-out trials, of a plain rig or of the arm;  changes  the model's numbers
    axis     unit of the position in it, which the rows name

    All other numbers as fitted,  shown = measured - without,  law = with - without,  in the unit
    of the effort; position and velocity in that of the axis.
    """
    rows, pieces = problem.rows, problem.stretches()
    along = {"time": "seconds", "position": "position", "velocity": "velocity"}
    signals: dict[str, Any] = {
        name: np.concatenate([getattr(p, field) for p in pieces]) for name, field in along.items()
    }
    signals |= {"axis": axis, "effort": problem.measured()[rows]}
    held, parts = problem(changes)[rows], []
    for effect in effects:
        bare = problem(without(effect, changes, problem))[rows]
        columns = {"effect": effect.name(), **signals, "shown": -bare, "law": held - bare}
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
