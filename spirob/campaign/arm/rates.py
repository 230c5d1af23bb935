"""Rates of a trial of arms with their 95 % intervals, and the answer key behind them.

The key says what each hidden kind of the emulated robot is called in the library of effects.
Several names are equal in what they do to the logs of one rig, and each counts as right; "" is the
right answer where the kind cannot be told from a fitted number.  Only scoring reads this. Intervals
are Wilson's (J. Am. Stat. Assoc. 22, 1927).
"""

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

ANSWERS: dict[str, tuple[str, ...]] = {
    "none": ("",),
    "asymmetric_viscous": ("asymmetric_viscous_friction",),
    "back_driving_loss": ("direction_dependent_efficiency", "load_dependent_friction"),
    "cogging": ("cogging",),
    "constant_pull": ("constant_force", "current_offset"),
    "current_gain": ("current_gain", ""),  # the efficiency takes it up
    "current_lag": ("current_lag", "feedback_latency"),
    "current_offset": ("current_offset", "constant_force"),
    "driver_dead_band": ("driver_dead_band",),
    "drum_build_up": ("drum_build_up", "eccentric_winch"),  # it is both: see TOGETHER
    "eccentric_drum": ("eccentric_winch",),
    "encoder_eccentricity": ("encoder_eccentricity",),
    "feedback_latency": ("feedback_latency", "current_lag"),
    "gear_backlash": ("backlash",),
    "gear_compliance": ("gear_compliance", "stretch"),
    "guide_friction": ("capstan_friction",),
    "joint_creep": ("joint_viscoelasticity",),
    "load_friction": ("load_dependent_friction", "direction_dependent_efficiency"),
    "magnetic_saturation": ("torque_constant_saturation",),
    "mount_tilt": ("mount_tilt",),
    "quadratic_drag": ("quadratic_drag",),
    "rest_curvature": ("rest_curvature",),
    "rotor_friction": ("coulomb_friction", "stribeck_friction", "presliding_friction"),
    "stiffness_hardening": ("stiffness_hardening",),
    "tendon_creep": ("creep",),
    "tendon_stretch": ("stretch", "gear_compliance"),
    "tight_spot": (),  # no name of the library is right
    "tip_payload": ("tip_payload",),
    "torque_ripple": ("torque_ripple",),
    "winding_heating": ("winding_heating",),
}

# Kinds that are several effects of the library at once, which the oracle knows together.  A drum on
# which layers pile up grows and runs out of true; a stroke of one turn shows the latter more.
TOGETHER: dict[str, tuple[str, ...]] = {"drum_build_up": ("drum_build_up", "eccentric_winch")}


def right(hidden: str, named: str) -> bool:
    """Whether the first name of a verdict ("" for none) answers what was hidden."""
    kinds = [part.split(":")[0] for part in hidden.split("+")]
    return any(named in ANSWERS.get(kind, ()) for kind in kinds)


def answers(kind: str) -> set[str]:
    """Names of the effects that are right where this kind is hidden, or several, "A+B"."""
    return {name for part in kind.split("+") for name in ANSWERS[part] if name}


LEAST_GAIN = 0.02  # where the oracle gains less, there is nothing to name
RANGE = 0.9  # of the base's error: the trial asks for effects with which the oracle leaves less
CONFIDENT = 0.9
REFUSED = ("unknown", "undecided")  # the right answers where the library lacks the effect
CLAIMS = (0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)  # edges of probability
LEAVES = (0.0, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)  # edges of oracle over base
WITHIN = (1.3, 2.0)  # times the held-out error of knowing what is hidden, of a composed law
Z = 1.96


def rate(hits: Iterable[bool]) -> dict[str, Any]:
    """Share of hits with its interval; `n` cases, and no value where there is none."""
    values = np.array(list(hits), dtype=float)
    n = len(values)
    if n == 0:
        return {"value": None, "low": 0.0, "high": 1.0, "n": 0}
    p = float(values.mean())
    middle = (p + Z**2 / (2 * n)) / (1 + Z**2 / n)
    half = Z / (1 + Z**2 / n) * float(np.sqrt(p * (1 - p) / n + Z**2 / (4 * n**2)))
    return {"value": p, "low": max(0.0, middle - half), "high": min(1.0, middle + half), "n": n}


def rates(results: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """All rates of a trial and its confusion matrix.

    A robot in which the drawn effect shows too little to be asked for (the oracle leaves more than
    0.9 of the error) is `outside`: no miss where it is not named, but wrong where it is wrongly.

    top1                 named, and the first name is right (undecided counts as a miss)
    exact                named, right, and nothing besides
    top3                 the right name is among the first three that were fitted in full
    false_alarm          of robots with nothing hidden, those for which something was named
    wrong_and_confident  of robots with one effect, wrongly named with at least 90 %, those outside
                         the range included
    outside              of robots with one effect
    undecided            of robots with one effect in the range
    called_unknown       of the same
    unknown              library without any right answer: called unknown or undecided, as is right
    left_out             the same, and no other effect named with confidence
    law_composed         the same, where the oracle gains enough: a law is composed
    law_within_1.3, law_within_2.0   and its held-out error, or what was said without one, is at
                         most so many times the oracle's
    pairs_both           of robots with two effects, both named
    excess_error_closed  share of the oracle's fall of the held-out error that naming achieved, mean
    """
    whole = [r for r in results if not r["without"]]
    nulls = [r for r in whole if nothing_to_name(r)]
    pairs = [r for r in whole if "+" in r["kind"] and r not in nulls]
    every = [r for r in whole if r not in nulls and r not in pairs]
    single = [r for r in every if asked(r)]
    left = [r for r in results if r["without"]]
    return {
        "cases": len(results),
        "top1": rate(is_right(r) for r in single),
        "exact": rate(is_right(r) and len(r["named"]) == 1 for r in single),
        "top3": rate(any(n in answers(r["kind"]) for n in r["first"][:3]) for r in single),
        "false_alarm": rate(r["verdict"] == "named" for r in nulls),
        "wrong_and_confident": rate(_confidently_wrong(r) for r in every),
        "outside": rate(not asked(r) for r in every),
        "undecided": rate(r["verdict"] == "undecided" for r in single),
        "called_unknown": rate(r["verdict"] == "unknown" for r in single),
        "unknown": rate(r["verdict"] in REFUSED for r in left if not nothing_to_name(r)),
        "left_out": rate(not _confidently_wrong(r) for r in left),
        **laws([r for r in left if asked(r)]),
        "pairs_both": rate(both(r) for r in pairs),
        "excess_error_closed": _closed([*single, *pairs]),
        "confusion": confusion(whole),
        "reliability": reliability([r for r in single if r["verdict"] == "named"]),
        "strength": by_strength(single),
    }


def laws(without: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """How often a law was composed where the library lacks the effect, and how good it is.

    Results of a program that composed none are left out.
    """
    known = [(r["composed"], r["heldout"]) for r in without if "composed" in r]
    over = [(law["heldout"] if law else e["named"]) / e["oracle"] for law, e in known]
    within = {f"law_within_{most}": rate(one <= most for one in over) for most in WITHIN}
    return {"law_composed": rate(bool(law) for law, _ in known)} | within


def left_by_oracle(result: Mapping[str, Any]) -> float:
    """Share of the error that knowing leaves.

    The oracle knows one of the accepted names; where another was named, that knew as much.
    """
    error = result["heldout"]
    known = [error["oracle"]] + [error["named"]] * is_right(result)
    return float(min(known) / error["base"])


def nothing_to_name(result: Mapping[str, Any]) -> bool:
    """Nothing is hidden, or so little that even knowing it would not help."""
    return result["kind"] == "none" or left_by_oracle(result) > 1.0 - LEAST_GAIN


def asked(result: Mapping[str, Any]) -> bool:
    """Whether the oracle gains as much as the trial means to ask for."""
    return left_by_oracle(result) <= RANGE


def is_right(result: Mapping[str, Any]) -> bool:
    """Named, and the first name is an accepted one."""
    named = result["named"]
    return bool(result["verdict"] == "named" and named and named[0] in answers(result["kind"]))


def both(result: Mapping[str, Any]) -> bool:
    """Two names, one for each hidden kind."""
    keys = [set(ANSWERS[kind]) for kind in result["kind"].split("+")]
    named = set(result["named"])
    return len(named) == len(keys) and all(named & key for key in keys)


def confusion(results: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, int]]:
    """What was hidden -> what was said -> how often."""
    table: dict[str, dict[str, int]] = {}
    for r in sorted(results, key=lambda r: str(r["kind"])):
        said = " + ".join(r["named"]) if r["verdict"] == "named" else str(r["verdict"])
        row = table.setdefault(r["kind"], {})
        row[said] = row.get(said, 0) + 1
    return table


def reliability(named: Sequence[Mapping[str, Any]]) -> list[dict[str, float]]:
    """How often a name is right, against the probability that was claimed for it."""
    table = []
    for low, high in pairwise(CLAIMS):
        inside = [r for r in named if low < r["probability"] <= high]
        if inside:
            said = float(np.mean([r["probability"] for r in inside]))
            right = rate(is_right(r) for r in inside)
            table.append(
                {"low": low, "high": high, "said": said, "right": right["value"]} | _n(right)
            )
    return table


def by_strength(single: Sequence[Mapping[str, Any]]) -> list[dict[str, float]]:
    """top1 against what knowing would leave of the held-out error."""
    table = []
    for low, high in pairwise(LEAVES):
        inside = [r for r in single if low <= left_by_oracle(r) < high]
        if inside:
            right = rate(is_right(r) for r in inside)
            table.append({"low": low, "high": high, "value": right["value"]} | _n(right))
    return table


def _n(found: Mapping[str, Any]) -> dict[str, Any]:
    return {"low_ci": found["low"], "high_ci": found["high"], "n": found["n"]}


def _confidently_wrong(result: Mapping[str, Any]) -> bool:
    sure = result["verdict"] == "named" and result["probability"] >= CONFIDENT
    return sure and not is_right(result)


def _closed(results: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    shares = []
    for r in results:
        error = r["heldout"]
        gain = error["base"] * (1.0 - left_by_oracle(r))
        shares.append(min(1.0, (error["base"] - error["named"]) / gain))
    if not shares:
        return {"value": None, "low": 0.0, "high": 1.0, "n": 0}
    values = np.array(shares)
    draws = np.random.default_rng(0).choice(values, (2000, len(values))).mean(axis=1)
    low, high = np.quantile(draws, [0.025, 0.975])
    return {"value": float(values.mean()), "low": float(low), "high": float(high), "n": len(values)}
