"""Rates of contacts told apart by where the peg stands and by how the arm comes to it.

Place and gap are drawn and are cut into equal parts, of contacts alone; speed and load, which set
how hard the arm presses, are those of the motions, whose free twins count as free motion.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from spirob.experiments.contact_rates import GAPS, MOTIONS, PLACES, Outcome, rates
from spirob.perceive.contact import ContactSettings

PARTS = 5


def in_parts(found: Sequence[Outcome], rules: ContactSettings) -> dict[str, Any]:
    """All rates of one detector on one signal, together and as by_place, by_gap and by_motion."""
    return {
        **rates(found, rules),
        "by_place": by_place(found, rules),
        "by_gap": by_gap(found, rules),
        "by_motion": by_motion(found, rules),
    }


def by_place(found: Sequence[Outcome], rules: ContactSettings) -> list[dict[str, Any]]:
    """Rates in five equal parts of the places; "place" is a part's middle, of the arm's length."""
    return _cut(found, rules, "place", PLACES, lambda one: one.place or 0.0)


def by_gap(found: Sequence[Outcome], rules: ContactSettings) -> list[dict[str, Any]]:
    """Rates in five equal parts of the gaps; "gap" is a part's middle [m]."""
    return _cut(found, rules, "gap", GAPS, lambda one: one.gap)


def by_motion(found: Sequence[Outcome], rules: ContactSettings) -> list[dict[str, Any]]:
    """Rates for each motion; "speed" [m/s] and "load" [A] are its own."""
    parts = []
    for speed, load in MOTIONS:
        there = [o for o in found if (o.speed, o.load) == (speed, load)]
        parts.append({"speed": speed, "load": load, **rates(there, rules)})
    return parts


def _cut(
    found: Sequence[Outcome],
    rules: ContactSettings,
    name: str,
    span: tuple[float, float],
    value: Callable[[Outcome], float],
) -> list[dict[str, Any]]:
    parts = []
    contacts = [o for o in found if o.place is not None]
    for low, high in pairwise(np.linspace(*span, PARTS + 1)):
        there = [o for o in contacts if low <= value(o) < high]
        middle = float(f"{(low + high) / 2:.6g}")
        parts.append({name: middle, **rates(there, rules)})
    return parts
