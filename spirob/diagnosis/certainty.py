"""How sure is a name?  As often as names with such figures were right in the campaign.

    p = 1/(1 + exp(-(w₀ + w_name + Σ w_k (x_k - m_k)/s_k)))

x are figures of what a search shows of one chosen effect (`figures`), six in all and five in each
of three regressions: of the name itself, on rigs and on a simulated "arm", whose few trials and
many numbers give intervals of another width; and of its kin, which is right where the name or one
that says a part of the same is.  w_name is how much surer, or less sure, an effect is than others
with the same figures: a flip at each reversal is hardly imitated, a wave over the place is.  A
fourth one, of how much of a proof a name accounts for, says by what its odds change (`proven`).
All numbers stand in `certainty.json` beside this file, with the cases that they were learned from
(`spirob.campaign.calibration`).  Logarithms are natural, errors squared:

fall_heldout   ln of the held-out error without the effect over that with it
ahead_heldout  ln of the held-out error of the best other model over that of the chosen one; the
               other is no richer, without the effect, and says something else
ahead_of_kin   the same, of models without its kin, too: what the kin is judged by
left           ln of what still follows from the motion over what this effect took
sharp          ln of an amplitude over half its interval's width, of the sharpest; its shape held
place          0 for the effect that takes most, then 1, 2, ...
share          of the squared error of a proof that the named effects account for, 0 to 1
"""

import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from spirob.diagnosis.model import Found, Left, Model, Predictor, alike
from spirob.diagnosis.search import Search
from spirob.effects import Effect
from spirob.identify.fit import Fit
from spirob.identify.intervals import with_held
from spirob.identify.problem import Problem

LEARNED = json.loads(Path(__file__).with_name("certainty.json").read_text())
FIGURES = {
    "name": ("fall_heldout", "ahead_heldout", "left", "sharp", "place"),
    "arm": ("fall_heldout", "ahead_heldout", "left", "sharp", "place"),
    "kin": ("fall_heldout", "ahead_of_kin", "left", "sharp", "place"),
    "proof": ("share",),
}
LIKELY = 0.5  # a name is given where it is more likely right than wrong
TINY = 1e-300
MOST = 10.0  # of a logarithm: what is larger says no more
MOSTLY = 0.5  # of the squared error that an effect takes: what differs by less makes most of it


def probability(figures: Mapping[str, float], effect: str, of: str = "name") -> float:
    """How likely the name of an effect with these figures is right, as it was in the campaign.

    effect  its name; one's own that was never played has no number of its own
    of      "name", on an "arm", or its "kin"
    """
    x, learned = np.array([figures[name] for name in FIGURES[of]]), LEARNED[of]
    mean, scale, weights = (np.array(learned[key]) for key in ("mean", "scale", "weights"))
    score = learned["bias"] + learned["names"].get(effect, 0.0) + weights @ ((x - mean) / scale)
    return float(1.0 / (1.0 + np.exp(-score)))


def proven(probability: float, share: float) -> float:
    """How likely a name is that accounts for this share of a trial of its own.

    Its odds, times how much likelier right names were to account for so much than wrong ones.
    """
    x, learned = float(np.clip(share, 0.0, 1.0)), LEARNED["proof"]
    (mean,), (scale,), (weight,) = (learned[key] for key in ("mean", "scale", "weights"))
    more = learned["bias"] + weight * (x - mean) / scale - learned["before"]
    odds = np.exp(more) * probability / max(1.0 - probability, TINY)
    return float(odds / (1.0 + odds))


def ratio(one: float, two: float) -> float:
    """ln of one over the other, both at least 0, within ± MOST."""
    return float(np.clip(np.log(max(one, TINY) / max(two, TINY)), -MOST, MOST))


def sharp(models: Predictor, found: Fit, effect: type[Effect]) -> float:
    """How far an amplitude is from what makes it neutral, in half widths of its interval: ln.

    Its shape is held, of which nothing is told where it is neutral.  So are numbers of a rig of
    which the trials tell nothing within their bounds: they cannot move as far as their own
    intervals to first order, and those of the amplitude, have it.  So are amplitudes that ended at
    a bound where they are neutral: without them the law is a plainer one.
    What ended at another bound is as large as it may be, which the bound tells and not the trials:
    it makes nothing sharp.  The arm's regression knows whole intervals.
    """
    amplitudes = {f"{effect.name()}.{field}": zero for field, zero in effect.neutral.items()}
    estimates, train = found.estimates, models.train
    if models.certainty != "arm":
        held = [n for n in models.names if n in estimates and is_untold(train, found, n)]
        absent = [n for n, zero in amplitudes.items() if is_absent(train, found, n, zero)]
        capped = {n for n in amplitudes if n in estimates and estimates[n].at_bound} - {*absent}
        held += absent if len(absent) < len(amplitudes) else []
        own = (f"{effect.name()}.{field}" for field in effect.fitted())
        held += [n for n in own if n in estimates and n not in amplitudes]
        estimates = with_held(train, found, held, models.robust) if held else estimates
        estimates = {n: e for n, e in estimates.items() if n not in capped}
    told = []
    for name, zero in amplitudes.items():
        if estimate := estimates.get(name):
            told.append(ratio(abs(estimate.value - zero), 0.5 * (estimate.high - estimate.low)))
    return max(told, default=0.0)


def is_untold(problem: Problem, found: Fit, name: str) -> bool:
    """Whether a number ended at a bound, or its interval reaches from bound to bound."""
    estimate, about = found.estimates[name], problem.table.about[name]
    return estimate.at_bound or (estimate.low <= about.low and estimate.high >= about.high)


def is_absent(problem: Problem, found: Fit, name: str, neutral: float) -> bool:
    """Whether an amplitude ended at that bound of its own where it is neutral."""
    estimate = found.estimates.get(name)
    if estimate is None or not estimate.at_bound:
        return False
    about = problem.table.about[name]
    off, far = abs(estimate.value - neutral), 0.5 * (about.high - about.low)
    return neutral in (about.low, about.high) and off < far


def rounded(figures: Mapping[str, float]) -> dict[str, float]:
    """Six digits, as they are kept."""
    return {name: float(f"{value:.6g}") for name, value in figures.items()}


@dataclass(frozen=True)
class Ended:
    """A search, what it found, and what is left beside the chosen model."""

    search: Search[Any]
    found: Found
    left: Left


def kin(search: Search[Any], found: Found, effect: type[Effect]) -> list[str]:
    """Names of the effects that make most of what this one makes, in its place; the best first.

    In the chosen model, where all beside it is, or on its rung, beside what takes more.
    """
    rung = next(model for model in found.rungs if effect in model.effects)
    makes = _in_place(search, rung, effect) | _in_place(search, found.chosen, effect)
    return sorted(makes, key=lambda name: makes[name])


def _in_place(search: Search[Any], model: Model, effect: type[Effect]) -> dict[str, float]:
    """The held-out squares of models with another effect in the place of this one, by its name.

    They differ from this model by less than half the squared error that the effect takes, on the
    samples that are fitted; the held-out trials refute none of them.
    """
    rest = model.names - {effect.name()}
    fall = search.models.tried[rest].mean_square - model.mean_square
    makes = {}
    for other in search.models.tried.values():
        name = other.names - rest
        if len(name) != 1 or len(other.names) != len(model.names) or other.names == model.names:
            continue
        apart = float(np.mean((other.fit.residual - model.fit.residual) ** 2))
        if apart < MOSTLY * fall and not search.worth.refuted(other, model):
            makes[next(iter(name))] = other.heldout_square
    return makes


def figures(ended: Ended, effect: type[Effect]) -> dict[str, float]:
    """What the search shows of one chosen effect."""
    search, found, left = ended.search, ended.found, ended.left
    chosen, bare = found.chosen, found.rungs[0]
    without = search.models.tried[chosen.names - {effect.name()}]
    fall = without.mean_square - chosen.mean_square
    order = [next(iter(b.names - a.names)) for a, b in pairwise(found.rungs)]

    def ahead(of: Collection[str]) -> float:
        others = [m.heldout_square for m in _others(search, chosen, of)]
        return ratio(min(others, default=bare.heldout_square), chosen.heldout_square)

    told = {
        "fall_heldout": ratio(without.heldout_square, chosen.heldout_square),
        "ahead_heldout": ahead({effect.name()}),
        "ahead_of_kin": ahead({effect.name(), *kin(search, found, effect)}),
        "left": ratio(left.share * chosen.mean_square, max(fall, 0.0)),
        "sharp": sharp(search.models, chosen.fit, effect),
        "place": float(order.index(effect.name())),
    }
    return rounded(told)


def _others(search: Search[Any], chosen: Model, names: Collection[str]) -> list[Model]:
    return [
        m
        for m in search.models.tried.values()
        if m.names.isdisjoint(names)
        and len(m.effects) <= len(chosen.effects)
        and not alike(m, chosen, search.worth.least)
    ]
