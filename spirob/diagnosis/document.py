"""The diagnosis as plain data, for the report, the metrics and other programs."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from spirob.diagnosis.evidence import half_seconds
from spirob.diagnosis.flexible import Ceiling, ceiling
from spirob.diagnosis.proposals import Proposal, told
from spirob.diagnosis.rungs import Confirmed, Ladder, Rung, label, missed_by, parameters_of
from spirob.diagnosis.verdict import Verdict
from spirob.identify.problem import Effort, Problem
from spirob.score import Interval, score, score_interval

CEILING = "flexible residual on top (ceiling)"
SENSELESS = "No verdict: the data or the model do not fit together."


def steps(search: Ladder, problems: Mapping[str, Problem]) -> tuple[list[dict[str, Any]], Ceiling]:
    """Rungs, the ceiling over the last one as a further entry, and the ceiling itself.

    problems  by role: those that the rungs were scored on
    """
    missed = [missed_by(rung, problems) for rung in search.rungs]
    found = [_rung(r, m, problems) for r, m in zip(search.rungs, missed, strict=True)]
    top = ceiling(problems, missed[-1])
    return [*found, _top(top, problems)], top


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


def document(
    search: Ladder,
    verdict: Verdict,
    where: Mapping[str, Any],
    noise_floor: float,
    problems: Mapping[str, Problem],
    proposals: Sequence[Proposal] = (),
) -> dict[str, Any]:
    """All of a diagnosis; errors in the unit of the effort.

    problems   by role: those that the rungs were scored on
    where      the residual lies, as `survey` tells it; an unknown effect is described by it
    proposals  experiments that would tell the rivals apart, or put a name to the proof, best first
    """
    added = search.rungs[-1].effects if verdict.kind == "named" else []
    last, effort = search.rungs[-1], problems["train"].effort
    ladder, ceiling = steps(search, problems)
    return {
        "verdict": verdict.kind,
        "sentence": verdict.sentence,
        "explanation": described(verdict.kind, verdict.explanation, where),
        "next_experiment": told(proposals, effort) or verdict.next_experiment,
        "next_trials": [t for p in proposals[:1] for t in p.trials],
        "effects": [
            {
                "name": effect.name(),
                "title": effect.title,
                "probability": verdict.evidence[effect.name()]["probability"],
                "equivalents": list(verdict.equivalents) if k == 0 else [],
                "parameters": _numbers(last, parameters_of(effect)),
            }
            for k, effect in enumerate(added)
        ],
        "evidence": [{"name": name, **one} for name, one in verdict.evidence.items()],
        "candidates": [_candidate(c) for c in (search.rounds[0] if search.rounds else [])],
        "ladder": ladder,
        "left": {"share": ceiling.share},
        "noise_floor": noise_floor,
        **where,
        "vague": search.vague,
        **({"floor": asdict(search.floor)} if search.floor else {}),
        "unit": effort.unit,
    }


def restated(before: Mapping[str, Any], verdict: Verdict, aside: bool) -> dict[str, Any]:
    """A diagnosis whose search stands, with the verdict after what was played.

    aside  what was played to decide told nothing; nothing more is asked for
    """
    if verdict.kind != before["verdict"]:
        return {
            **before,
            "verdict": verdict.kind,
            "sentence": verdict.sentence,
            "explanation": described(verdict.kind, verdict.explanation, before),
            "next_experiment": verdict.next_experiment,
            "next_trials": [],
            "effects": [],
        }
    done = aside or verdict.kind == "named"
    return {**before, **({"next_experiment": "", "next_trials": []} if done else {})}


def described(kind: str, explanation: str, where: Mapping[str, Any]) -> str:
    """The explanation; of an unknown effect also what the residual depends on, where known."""
    depends = where.get("depends", {}).get("sentence", "")
    return f"{explanation} {depends}" if kind == "unknown" and depends else explanation


def metrics(search: Ladder, verdict: Verdict, effort: Effort) -> dict[str, Any]:
    """The few figures that `dvc metrics` follows, with their unit."""
    first, last = search.rungs[0].scores["heldout"], search.rungs[-1].scores["heldout"]
    named = [e.name() for e in search.rungs[-1].effects] if verdict.kind == "named" else []
    return {
        "verdict": verdict.kind,
        "effect": named[0] if named else "",
        "effects": " + ".join(named),
        "probability": round(verdict.probability, 6),
        "before": first.as_dict(),
        "after": last.as_dict(),
        "unit": effort.unit,
    }


def _numbers(rung: Rung, names: Sequence[str]) -> dict[str, Any]:
    estimates = rung.fit.estimates
    return {
        n.split(".", 1)[1]: {
            "value": estimates[n].value,
            "low": estimates[n].low,
            "high": estimates[n].high,
            "unit": estimates[n].unit,
        }
        for n in names
        if n in estimates
    }


def _candidate(found: Confirmed) -> dict[str, Any]:
    return {
        "name": label(found.effects),
        "title": " and ".join(e.title for e in found.effects),
        "probability": found.probability,
        "train_rmse": found.scores["train"].rmse,
        "validate_rmse": found.scores["validate"].rmse,
        "heldout_rmse": found.scores["heldout"].rmse,
        "screen_gain": found.gain,
    }
