"""What the data do not tell, in physical words.

A direction is a change of several numbers at once, each relative to its size, that leaves every
signal as it is.  Two numbers that move against each other are known by their product, two that move
together by their ratio; loads that grow together with what pulls them are the scale of force.
"""

from collections.abc import Mapping

import numpy as np

from spirob.identify.scaling import STRENGTH
from spirob.parameter import Table

NAMED = 0.3  # of the largest share in a direction
EQUAL = 0.05  # relative difference of shares that count as the same
PULL = (STRENGTH, "motor.torque_constant")  # what a current pulls with
LOADS = ("motor.rotor_inertia", "motor.rotor_damping", "arm.base_stiffness")


def symbol(name: str, table: Table) -> str:
    """A number as a reader finds it again: its symbol and its key."""
    return f"{table.about[name].symbol} ({name})"


def told(direction: Mapping[str, float], table: Table, effort: str, weighed: bool) -> str:
    """A direction that moves nothing, and what is known all the same.

    weighed  a known weight hung in some trial
    """
    strong = _strong(direction)
    names = [symbol(n, table) for n in strong]
    shares = np.array(list(strong.values()))
    if len(strong) == 1:
        return f"{names[0]} moves nothing."
    if len(strong) == 2 and abs(abs(shares[0] / shares[1]) - 1.0) < EQUAL:
        what = "ratio" if shares[0] * shares[1] > 0 else "product"
        return f"{_listed(names)} cannot be told apart: only their {what} moves the {effort}."
    return f"A growth of {_moved(strong, table)} changes nothing{_scale(strong, weighed)}."


def weakest(direction: Mapping[str, float], times: float, table: Table, weighed: bool) -> str:
    """The direction that the data hold least, though they hold it."""
    strong = _strong(direction)
    return (
        f"The data hold least on a growth of {_moved(strong, table)}: {times:.0f} times less than "
        f"on the strongest combination{_scale(strong, weighed)}."
    )


def _strong(direction: Mapping[str, float]) -> dict[str, float]:
    largest = max(abs(v) for v in direction.values())
    kept = {n: v for n, v in direction.items() if abs(v) >= NAMED * largest}
    return dict(sorted(kept.items(), key=lambda pair: -abs(pair[1])))


def _moved(strong: Mapping[str, float], table: Table) -> str:
    first = next(iter(strong.values()))
    up = [symbol(n, table) for n, v in strong.items() if v * first > 0]
    down = [symbol(n, table) for n, v in strong.items() if v * first < 0]
    together = " together" if len(up) > 1 else ""
    against = f" while {_listed(down)} {'falls' if len(down) == 1 else 'fall'}" if down else ""
    return f"{_listed(up)}{together}{against}"


def _scale(strong: Mapping[str, float], weighed: bool) -> str:
    pulls = [strong[n] for n in PULL if n in strong]
    loads = [strong[n] for n in LOADS if n in strong]
    if not pulls or not loads or any(v * pulls[0] < 0 for v in loads):
        return ""
    remedy = "" if weighed else "; a trial with a known weight (scene: weights) fixes it"
    return (
        ": the scale of force, because a stronger gear on a stiffer, heavier arm draws the same "
        f"current, and inertia, damping and stiffness are known over η k_t alone{remedy}"
    )


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
