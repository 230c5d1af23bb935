"""The ladder as plain data: the scores of every rung with intervals, then the flexible ceiling."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from spirob.diagnosis.evidence import half_seconds
from spirob.diagnosis.flexible import Ceiling, ceiling
from spirob.diagnosis.rungs import ROLES, Rung, Search
from spirob.identify.problem import Problem
from spirob.score import score
from spirob.score_interval import Interval, score_interval

CEILING = "flexible residual on top (ceiling)"


def steps(search: Search, problems: Mapping[str, Problem]) -> tuple[list[dict[str, Any]], Ceiling]:
    """Rungs, the ceiling over the last one as a further entry, and the ceiling itself.

    problems  by role: those that the rungs were scored on
    """
    missed = [_missed(rung, problems) for rung in search.rungs]
    found = [_rung(r, m, problems) for r, m in zip(search.rungs, missed, strict=True)]
    top = ceiling(problems, missed[-1])
    return [*found, _top(top, problems)], top


def _missed(rung: Rung, problems: Mapping[str, Problem]) -> dict[str, np.ndarray]:
    """Model minus measurement by role, (N,) each."""
    others = {role: problems[role](rung.fit.changes) for role in ROLES if role != "train"}
    return {"train": rung.fit.residual, **others}


def _rung(
    rung: Rung, missed: Mapping[str, np.ndarray], problems: Mapping[str, Problem]
) -> dict[str, Any]:
    scores = {role: s.as_dict() for role, s in rung.scores.items()}
    effort = {role: values[problems[role].rows] for role, values in missed.items()}
    return {
        "label": rung.label,
        "effects": [e.name() for e in rung.effects],
        **scores,
        "interval": _intervals(effort, problems),
    }


def _top(found: Ceiling, problems: Mapping[str, Problem]) -> dict[str, Any]:
    scores = {}
    for role, left in found.left.items():
        measured = problems[role].measured()[problems[role].rows]
        scores[role] = score(measured, measured + left).as_dict()
    intervals = _intervals(found.left, problems)
    return {"label": CEILING, "effects": [], **scores, "interval": intervals, "ceiling": True}


def _intervals(
    missed: Mapping[str, np.ndarray], problems: Mapping[str, Problem]
) -> dict[str, dict[str, Interval]]:
    """95 % intervals of the scores, by role; `missed` of the effort alone, (n,) each."""
    found = {}
    for role, values in missed.items():
        measured = problems[role].measured()[problems[role].rows]
        found[role] = score_interval(measured, measured + values, half_seconds(problems[role]))
    return found
