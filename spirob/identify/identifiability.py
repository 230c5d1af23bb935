"""The gate before a fit: what moves a signal, what starts on a bound, what cannot be told apart.

What the data do not tell is said in physical words.  A direction is a change of several numbers at
once, each relative to its size, that leaves every signal as it is.  Two numbers that move against
each other are known by their product, two that move together by their ratio; loads that grow
together with what pulls them are the scale of force.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from spirob.identify.fit import differences
from spirob.identify.problem import Problem, effort_rms
from spirob.identify.scaling import STRENGTH, Scaling
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


def weakest_direction(
    direction: Mapping[str, float], times: float, table: Table, weighed: bool
) -> str:
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


SILENT = 2e-6  # of the effort's RMS per relative change: far below the resolution of any drive
WEAK = 1e-2  # a direction this much weaker than the strongest is called weak
# and this much weaker is no direction at all: doubling numbers along it moves a typical current by
# 30 µA, which half a minute of samples does not tell from noise; differences are exact to 1e-5
NULL = 1e-4
TENTH = 0.1


@dataclass(frozen=True)
class Identifiability:
    """What the data can say about a set of parameters.

    moves      RMS change of the effort for a tenth of each, in its unit
    silent     parameters that move no signal
    at_bound   parameters that start on a bound
    null       combinations that move nothing, coefficients by parameter, each led by one that is
               in no other
    held       parameters to leave at their start so that no such combination is left
    condition  ratio of the strongest to the weakest direction, among those that move something
    weakest    coefficients of that weakest direction, by parameter
    sentence   the same in words
    """

    moves: dict[str, float]
    silent: list[str]
    at_bound: list[str]
    null: list[dict[str, float]]
    held: list[str]
    condition: float
    weakest: dict[str, float]
    sentence: str

    def plain(self) -> dict[str, Any]:
        """Plain data, numbers to four digits."""
        return {key: _rounded(value) for key, value in asdict(self).items()}


def probe(
    residual: Problem, names: Sequence[str], start: Mapping[str, float], weighed: bool = False
) -> Identifiability:
    """Differentiate the residual at `start` by each named parameter and look at the directions.

    weighed  a known weight hangs in some trial, which fixes the scale of force
    """
    table = residual.table
    scaling = Scaling(table, names)
    values = {n: start.get(n, float(table.values[table.position(n)])) for n in names}
    fixed = {k: v for k, v in start.items() if k not in names}
    u = scaling.scaled(values)
    slopes = differences(residual, scaling, u, fixed) @ np.linalg.inv(scaling.relative(u))
    jacobian = slopes * _shares(scaling, values, table)
    strength = np.sqrt(np.mean(jacobian**2, axis=0))
    heard = strength >= SILENT * effort_rms(residual)
    kept = [n for n, one in zip(names, heard, strict=True) if one]
    slopes = jacobian[:, heard]
    null = null_space(slopes, kept)
    held = _held(null, names)
    left = [n for n in kept if n not in held]
    condition, weakest = _weakest(slopes, kept)
    rest = _weakest(slopes[:, [n in left for n in kept]], left) if held else (condition, weakest)
    moves = {n: TENTH * float(s) for n, s in zip(names, strength, strict=True)}
    silent = [n for n in names if n not in kept]
    known = {n: float(table.values[table.position(n)]) for n in names}
    bound = [n for n in names if table.about[n].at_bound(values[n], known[n])]
    found = Identifiability(moves, silent, bound, null, held, condition, weakest, "")
    return Identifiability(**{**vars(found), "sentence": _sentence(found, rest, residual, weighed)})


def _shares(scaling: Scaling, values: Mapping[str, float], table: Table) -> np.ndarray:
    # the coordinates count in sizes, words in shares of the number itself, where it has one
    shares = []
    for name, size in zip(scaling.names, scaling.size, strict=True):
        about = table.about[name]
        own = about.nominal != 0.0 and values[name] != 0.0 and not about.log
        shares.append(abs(values[name]) / size if own else 1.0)
    return np.array(shares)


def null_space(slopes: np.ndarray, names: Sequence[str]) -> list[dict[str, float]]:
    """Directions along which the slopes vanish, row-reduced, so that each names few parameters."""
    if not len(names):
        return []
    _, singular, rows = np.linalg.svd(np.linalg.qr(slopes, mode="r"), full_matrices=True)
    least = NULL * singular[0]
    basis = rows[int(np.sum(singular > least)) :].copy()
    taken: list[int] = []
    for k, row in enumerate(basis):
        lead = int(np.argmax(np.where(np.isin(np.arange(len(row)), taken), 0.0, np.abs(row))))
        basis[k] = row / row[lead]
        others = [j for j in range(len(basis)) if j != k]
        basis[others] -= np.outer(basis[others, lead], basis[k])
        taken.append(lead)
    unit = basis / np.linalg.norm(basis, axis=1, keepdims=True)
    return [{n: float(c) for n, c in zip(names, row, strict=True) if abs(c) > 0.01} for row in unit]


def _held(null: Sequence[Mapping[str, float]], names: Sequence[str]) -> list[str]:
    # of each combination the one that was asked for last
    held: list[str] = []
    for direction in null:
        strong = [n for n in names if abs(direction.get(n, 0.0)) > NAMED and n not in held]
        held += strong[-1:]
    return held


def _weakest(slopes: np.ndarray, names: Sequence[str]) -> tuple[float, dict[str, float]]:
    if not len(names):
        return 1.0, {}
    _, singular, rows = np.linalg.svd(slopes, full_matrices=False)
    condition = float(singular[0] / max(singular[-1], 1e-300))
    return condition, {n: float(c) for n, c in zip(names, rows[-1], strict=True)}


def _sentence(
    found: Identifiability, rest: tuple[float, dict[str, float]], residual: Problem, weighed: bool
) -> str:
    table, effort = residual.table, residual.effort.name
    said = []
    if found.silent:
        said.append(
            f"These parameters move no signal and cannot be fitted: {', '.join(found.silent)}."
        )
    if found.at_bound:
        said.append(f"On a bound from the start: {', '.join(found.at_bound)}.")
    said += [told(direction, table, effort, weighed) for direction in found.null]
    if found.held:
        said.append(f"Held at their start for that reason: {', '.join(found.held)}.")
    condition, weakest = rest
    if len(weakest) > 1 and condition * WEAK >= 1.0:
        said.append(weakest_direction(weakest, condition, table, weighed))
    if not said:
        return f"Every fitted parameter, and every combination of them, moves the {effort} clearly."
    return " ".join(said)


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.4g}")
    if isinstance(value, dict):
        return {k: _rounded(v) for k, v in value.items()}
    if isinstance(value, list):
        return [_rounded(v) for v in value]
    return value
