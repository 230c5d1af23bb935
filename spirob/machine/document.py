"""A rig's diagnosis as plain data: what `diagnosis.json` holds."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from spirob.diagnosis.atlas import Regime, worst
from spirob.diagnosis.document import CEILING
from spirob.diagnosis.evidence import half_seconds, noise_floor
from spirob.diagnosis.flexible import worth
from spirob.diagnosis.spectrum import orders
from spirob.diagnosis.survey import lateness
from spirob.machine.flexible import Ceiling
from spirob.machine.judgement import Judgement
from spirob.machine.models import Model
from spirob.machine.rig import RigFile
from spirob.machine.search import Found, Search
from spirob.score import Interval, score, score_interval


def document(
    rig: RigFile,
    search: Search,
    found: Found,
    judgement: Judgement,
    rest: Ceiling,
    regimes: Sequence[Regime],
    repairs: Sequence[str],
    excluded: dict[str, str],
) -> dict[str, Any]:
    """All of a diagnosis, in SI; a number that is not finite becomes null."""
    effort = search.train.effort
    named = judgement.kind in ("named", "undecided")
    pieces, bare = search.train.stretches(), found.rungs[0].fit.residual
    written = {
        "rig": rig.name,
        "predict": rig.predict,
        "verdict": judgement.kind,
        "sentence": judgement.sentence,
        "explanation": judgement.explanation,
        "next_experiment": judgement.next_experiment,
        "effects": [
            {
                "name": e.name(),
                "title": e.title,
                "probability": judgement.weighed[e.name()].probability,
                "together": judgement.weighed[e.name()].together,
                "equivalents": judgement.weighed[e.name()].equivalents,
                "rivals": judgement.weighed[e.name()].rivals,
                "parameters": _numbers(found.chosen, e.name()),
            }
            for e in (found.chosen.effects if named else ())
        ],
        "evidence": [
            {
                "name": name,
                "probability": one.probability,
                "together": one.together,
                "equivalents": one.equivalents,
                "rivals": one.rivals,
                "figures": one.figures,
            }
            for name, one in judgement.weighed.items()
        ],
        "candidates": _candidates(search, found, judgement),
        "ladder": [*_ladder(search, found), _flexible(search, found, rest)],
        "noise_floor": noise_floor(search.train),
        "atlas": [r.as_dict() for r in regimes],
        "atlas_sentences": worst(regimes, effort),
        "atlas_orders": [w.as_dict() for w in orders(pieces, bare)],
        "atlas_lateness": lateness(pieces, bare),
        "unit": effort.unit,
        "effort": effort.name,
        "effort_rms": {"train": search.models.size, "test": _rms(search.heldout.measured())},
        "repairs": list(repairs),
        "excluded": excluded,
        "numbers": _numbers(found.chosen, "rig"),
        "left": {"share": rest.share, "alone": rest.alone},
    }
    return plain(written)  # type: ignore[no-any-return]


def _numbers(model: Model, owner: str) -> dict[str, Any]:
    return {
        name.split(".", 1)[1]: {"value": e.value, "low": e.low, "high": e.high, "unit": e.unit}
        for name, e in model.fit.estimates.items()
        if name.split(".", 1)[0] == owner
    }


def _candidates(search: Search, found: Found, judgement: Judgement) -> list[dict[str, Any]]:
    """Every effect that was considered, the most probable first.

    heldout_rmse  of the best fitted model that holds it and is no larger than the chosen one, which
                  for a chosen effect is the chosen one; null where screening ended it
    """
    entries = []
    most = max(1, len(found.chosen.effects))
    for offer in found.offers:
        name = offer.effect.name()
        models = [
            m for m in search.models.tried.values() if name in m.names and len(m.effects) <= most
        ]
        models = [found.chosen] if name in found.chosen.names else models
        best = min(models, key=lambda m: m.mean_square) if models else None
        single = search.models.tried.get(frozenset({name}))
        own = judgement.weighed.get(name)
        probability = own.probability if own else 0.0
        for one in judgement.weighed.values():
            if name in one.rivals:
                shared = one.together if one.together > one.probability else 1.0
                probability = max(probability, (shared - one.probability) / len(one.rivals))
        gain = 1.0 - offer.error / found.rungs[0].mean_square
        entries.append(
            {
                "name": name,
                "title": offer.effect.title,
                "probability": probability,
                "heldout_rmse": None if best is None else float(np.sqrt(best.heldout_square)),
                "with": [] if best is None else sorted(best.names - {name}),
                "train_rmse": None if best is None else _rms(best.fit.residual),
                "alone_heldout_rmse": None
                if single is None
                else float(np.sqrt(single.heldout_square)),
                "screen_gain": gain,
            }
        )
    return sorted(entries, key=lambda e: -e["probability"])


def _ladder(search: Search, found: Found) -> list[dict[str, Any]]:
    rungs = []
    for model in found.rungs:
        names = [e.name() for e in model.effects]
        label = " + ".join(["fitted numbers", *(n.replace("_", " ") for n in names)])
        both = {role: s.as_dict() for role, s in search.models.scores(model).items()}
        intervals = _intervals(search, model.fit.residual, model.heldout)
        rungs.append({"label": label, "effects": names, **both, "interval": intervals})
    return rungs


def _flexible(search: Search, found: Found, rest: Ceiling) -> dict[str, Any]:
    """The ceiling: what a flexible residual on top of the chosen model would reach."""
    measured, held = search.train.measured(), search.heldout.measured()
    before = found.chosen.fit.residual
    guess = before - rest.left
    left = before - worth(before, guess) * guess  # as on the held-out trials
    return {
        "label": CEILING,
        "effects": [],
        "train": score(measured, measured + left).as_dict(),
        "test": score(held, held + rest.heldout).as_dict(),
        "interval": _intervals(search, left, rest.heldout),
        "ceiling": True,
    }


def _intervals(
    search: Search, train: np.ndarray, heldout: np.ndarray
) -> dict[str, dict[str, Interval]]:
    """95 % intervals of the scores of what a model misses on either role, (N,) and (M,)."""
    found = {}
    for role, problem, missed in (
        ("train", search.train, train),
        ("test", search.heldout, heldout),
    ):
        measured = problem.measured()
        found[role] = score_interval(measured, measured + missed, half_seconds(problem))
    return found


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def plain(node: Any) -> Any:
    """Plain data of nine digits; a number that is not finite becomes null."""
    if isinstance(node, dict):
        return {str(key): plain(value) for key, value in node.items()}
    if isinstance(node, list | tuple):
        return [plain(value) for value in node]
    if isinstance(node, float | np.floating):
        return float(f"{node:.9g}") if math.isfinite(node) else None
    return node
