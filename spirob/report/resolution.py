"""Correlation and null space of a fit, in words.

Two numbers that go together can change in step without the data noticing: only their ratio (or,
where they go against each other, their product) is known well.
"""

from typing import Any

import numpy as np

from spirob.report.numbers import fixed, number

TOGETHER = 0.9  # correlation from which two numbers are said to go together
SHARE = 0.25  # of the unit combination, from which a number is named in it
FORCE_SCALE = ("efficiency", "damping", "inertia", "stiffness")
ALIKE = 0.8  # cosine between the weakest combination and all numbers growing in step
MILLI = {"A": "mA", "V": "mV", "N·m": "mN·m", "N": "mN"}


def pairs(resolution: dict[str, Any]) -> list[str]:
    """A sentence for every two numbers that the data hold only together, the closest first."""
    names, table = resolution["names"], resolution["correlation"]
    found = [
        (table[i][k], names[i], names[k])
        for i in range(len(names))
        for k in range(i + 1, len(names))
        if abs(table[i][k]) >= TOGETHER
    ]
    return [
        f"{spoken(a).capitalize()} and {spoken(b)} (correlation {fixed(value, 2)}): their "
        f"{'ratio' if value > 0 else 'product'} is known better than either."
        for value, a, b in sorted(found, key=lambda pair: -abs(pair[0]))
    ]


def null_space(resolution: dict[str, Any], left: float | None) -> str:
    """What the data hardly tell: the combination, what a tenth along it does, and why.

    left  RMS that the fit leaves, in the unit of the effort, for comparison
    """
    weakest, unit = resolution["weakest"], resolution["unit"]
    least, most = (_small(resolution[k], unit) for k in ("least", "most"))
    rest = "" if left is None else f"; the fit leaves {_small(left, unit)}"
    sentence = (
        f"Least known is {_combination(weakest)}: a tenth along it changes the effort by {least} "
        f"RMS, a tenth along the best known combination by {most}{rest}."
    )
    return f"{sentence} {_why(weakest)}".strip()


def _combination(weakest: dict[str, float]) -> str:
    strong = {n: v for n, v in weakest.items() if abs(v) >= SHARE * max(map(abs, weakest.values()))}
    up = [name for name, value in strong.items() if value > 0]
    down = [name for name, value in strong.items() if value <= 0]
    if len(strong) == 1:
        return f"{_listed(up + down)} alone"
    if not (up and down):
        return f"{_listed(up + down)} growing or falling together"
    return f"{_listed(up)} growing against {_listed(down)}"


def _why(weakest: dict[str, float]) -> str:
    """The reason, where it is the known one: current alone does not carry the scale of force."""
    parts = [name.rpartition(".")[2] for name in weakest]
    known = all(any(word in part for word in FORCE_SCALE) for part in parts)
    size = np.linalg.norm(list(weakest.values())) * np.sqrt(len(weakest))
    if len(parts) < 3 or not known or abs(sum(weakest.values())) / size < ALIKE:
        return ""
    return (
        "That is the scale of force: a stronger gear on a stiffer, heavier arm draws the same "
        "current. A trial with a known weight fixes it."
    )


def spoken(name: str) -> str:
    """A number's name without dots and underscores: 'motor rotor inertia' → 'rotor inertia'."""
    owner, _, own = name.rpartition(".")
    own = own.replace("_", " ")
    return own if " " in own or not owner else f"{owner} {own}"


def _listed(names: list[str]) -> str:
    texts = [spoken(name) for name in names]
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} and {texts[-1]}"


def _small(value: float, unit: str) -> str:
    if unit in MILLI and abs(value) < 1:
        return f"{number(1e3 * value)} {MILLI[unit]}"
    return f"{number(value)} {unit}"
