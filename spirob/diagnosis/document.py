"""The diagnosis as plain data, for the report, the metrics and other programs."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from spirob.diagnosis.certainty import LIKELY, Ended
from spirob.diagnosis.criteria import half_seconds
from spirob.diagnosis.flexible import Ceiling, ceiling
from spirob.diagnosis.model import Found, Model, label
from spirob.diagnosis.proposals import Proposal, told
from spirob.diagnosis.search import Search
from spirob.diagnosis.simulated import Simulated
from spirob.diagnosis.verdict import Verdict
from spirob.identify.intervals import Interval, score, score_interval
from spirob.identify.problem import Problem, rms

CEILING = "flexible residual on top (ceiling)"


def findings(verdict: Verdict, chosen: Model) -> dict[str, Any]:
    """The keys `effects`, those that are named or between which nothing is decided, and `evidence`.

    The numbers of an effect, its motors' differences included, with intervals.
    """
    named = verdict.kind in ("named", "undecided")
    return {
        "effects": [
            {
                "name": e.name(),
                "title": e.title,
                **_sure(verdict, e.name()),
                "parameters": numbers(chosen, e.name()),
            }
            for e in (chosen.effects if named else ())
        ],
        "evidence": [
            {"name": name, **_sure(verdict, name), "figures": one.figures}
            for name, one in verdict.weighed.items()
        ],
    }


def _sure(verdict: Verdict, name: str) -> dict[str, Any]:
    one = verdict.weighed[name]
    return {
        "probability": one.probability,
        "together": one.together,
        "equivalents": list(one.equivalents),
        "rivals": list(one.rivals),
    }


def numbers(model: Model, owner: str) -> dict[str, Any]:
    """The fitted numbers of an owner, without its name."""
    return {
        name.split(".", 1)[1]: e.plain
        for name, e in model.fit.estimates.items()
        if name.split(".", 1)[0] == owner
    }


def candidates(search: Search[Any], found: Found, verdict: Verdict) -> list[dict[str, Any]]:
    """Every effect that was considered, the most probable first, then what leaves least.

    heldout_rmse  of the best fitted model that holds it and is no larger than the chosen one, which
                  for a chosen effect is the chosen one; null where screening ended it
    left_out_rmse, train_rmse  of the same model, on what decides and on what is fitted
    """
    entries = []
    for offer in found.offers:
        name = offer.effect.name()
        best = _best(search, found.chosen, name)
        single = search.models.tried.get(frozenset({name}))
        entries.append(
            {
                "name": name,
                "title": offer.effect.title,
                "probability": _probability(verdict, name),
                "heldout_rmse": None if best is None else float(np.sqrt(best.heldout_square)),
                "left_out_rmse": None if best is None else float(np.sqrt(best.mean_square)),
                "train_rmse": None if best is None else rms(best.fit.residual),
                "with": [] if best is None else sorted(best.names - {name}),
                "alone_heldout_rmse": None
                if single is None
                else float(np.sqrt(single.heldout_square)),
                "screen_gain": 1.0 - offer.error / found.rungs[0].mean_square,
            }
        )
    return sorted(entries, key=lambda e: (-e["probability"], e["left_out_rmse"] is None))


def _best(search: Search[Any], chosen: Model, name: str) -> Model | None:
    """The best fitted model with an effect, no larger than the chosen one."""
    if name in chosen.names:
        return chosen
    most = max(1, len(chosen.effects))
    models = [m for m in search.models.tried.values() if name in m.names and len(m.effects) <= most]
    return min(models, key=lambda m: m.mean_square, default=None)


def _probability(verdict: Verdict, name: str) -> float:
    """How likely an effect is there; of rivals what is left of the chosen one's probability.

    Who stands in the place of an effect that is unlikely itself is no likelier for it.
    """
    own = verdict.weighed.get(name)
    probability = own.probability if own else 0.0
    for one in verdict.weighed.values():
        if name in one.rivals:
            either = 1.0 if one.probability >= LIKELY else 0.0
            shared = one.together if one.together > one.probability else either
            probability = max(probability, (shared - one.probability) / len(one.rivals))
    return probability


def steps(found: Found, models: Simulated) -> tuple[list[dict[str, Any]], Ceiling]:
    """Rungs, the ceiling over the last one as a further entry, and the ceiling itself."""
    problems = models.residuals
    missed = [models.missed(model) for model in found.rungs]
    rungs = [_rung(m, values, models) for m, values in zip(found.rungs, missed, strict=True)]
    top = ceiling(problems, missed[-1])
    return [*rungs, _top(top, problems)], top


def _rung(model: Model, missed: Mapping[str, np.ndarray], models: Simulated) -> dict[str, Any]:
    problems = models.residuals
    effort = {role: values[problems[role].rows] for role, values in missed.items()}
    names = f"+ {label(model.effects)}" if model.effects else "fitted parameters"
    return {
        "label": names,
        "effects": [e.name() for e in model.effects],
        **{role: s.as_dict() for role, s in models.scores(model).items()},
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
    ended: Ended,
    verdict: Verdict,
    where: Mapping[str, Any],
    noise_floor: float,
    proposals: Sequence[Proposal] = (),
) -> dict[str, Any]:
    """All of an arm's diagnosis; errors in the unit of the effort.

    where      the residual lies, as `survey` tells it; an unknown effect is described by it
    proposals  experiments that would tell the rivals apart, or put a name to the proof, best first
    """
    search, found = ended.search, ended.found
    models: Simulated = search.models
    effort = models.train.effort
    ladder, top = steps(found, models)
    return {
        "verdict": verdict.kind,
        "sentence": verdict.sentence,
        "explanation": described(verdict, where),
        "doubts": list(verdict.doubts),
        "next_experiment": told(proposals, effort) or verdict.next_experiment,
        "next_trials": [t for p in proposals[:1] for t in p.trials],
        **findings(verdict, found.chosen),
        "candidates": candidates(search, found, verdict),
        "ladder": ladder,
        "left": {"share": top.share},
        "noise_floor": noise_floor,
        **where,
        "vague": models.vague,
        **({"floor": asdict(models.floor_of(found.chosen))} if models.measure else {}),
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
            "explanation": described(verdict, before),
            "next_experiment": verdict.next_experiment,
            "next_trials": [],
            "effects": [],
        }
    done = aside or verdict.kind == "named"
    return {**before, **({"next_experiment": "", "next_trials": []} if done else {})}


def described(verdict: Verdict, where: Mapping[str, Any]) -> str:
    """The explanation; of an unknown effect also what the residual depends on, where known."""
    depends = where.get("depends", {}).get("sentence", "")
    unknown = verdict.kind == "unknown" and depends
    return f"{verdict.explanation} {depends}" if unknown else verdict.explanation


def metrics(ended: Ended, verdict: Verdict) -> dict[str, Any]:
    """The few figures that `dvc metrics` follows, with their unit."""
    models, found = ended.search.models, ended.found
    first, last = (models.scores(found.rungs[k])["heldout"] for k in (0, -1))
    named = [e.name() for e in found.chosen.effects] if verdict.kind == "named" else []
    return {
        "verdict": verdict.kind,
        "effect": named[0] if named else "",
        "effects": " + ".join(named),
        "probability": round(verdict.probability, 6),
        "before": first.as_dict(),
        "after": last.as_dict(),
        "unit": models.train.effort.unit,
    }
