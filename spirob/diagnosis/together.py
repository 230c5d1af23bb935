"""Several candidates at once: the numbers to play them with, to first order.

Each candidate was fitted alone, and what that did to the residual is known; so is the derivative of
the residual by the fitted numbers.  Several together are taken as

    r = r_0 + Σ w_e·(r_e - r_0 - J·(u_e - u_0)) + J·(u - u_0),     0 ≤ w_e ≤ 1,

with the shares w and the coordinates u of the fitted numbers (see `scaling`) that cost least on the
training trials.  Only the numbers come from this sum; what they are worth, the model itself says
when it plays the trials again with them.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spirob.diagnosis.screen import amplitudes
from spirob.effects import Effect
from spirob.identify.descent import linear_step
from spirob.identify.fit import Fit, anchor_of
from spirob.identify.problem import Problem
from spirob.identify.scaling import Scaling

LINEAR_STEPS = 2  # of the linear problem, whose weights follow the residual


@dataclass(frozen=True)
class Alone:
    """A candidate added to the base model and fitted alone.

    changes   all numbers of that model;  residual  on the training trials
    refitted  fitted in full simulation; otherwise where the screening left it
    """

    effect: type[Effect]
    changes: dict[str, float]
    residual: np.ndarray
    refitted: bool = True


def together(
    problem: Problem, base: Fit, chosen: Sequence[Alone], scale: float
) -> dict[str, float]:
    """Numbers of the model with all the chosen effects; `problem` is that of the training trials.

    scale  of the robust loss, in the unit of the residual
    """
    table = problem.table
    scaling = Scaling(table, list(base.estimates))
    values = dict(zip(table.names, table.values.tolist(), strict=True)) | base.changes
    start = scaling.scaled(values)
    moves = [scaling.scaled({**values, **one.changes}) - start for one in chosen]
    shifts = [
        one.residual - base.residual - base.jacobian @ move
        for one, move in zip(chosen, moves, strict=True)
    ]
    slopes = np.column_stack([*shifts, base.jacobian])
    count = len(chosen)
    low = np.concatenate([np.zeros(count), scaling.low - start])
    high = np.concatenate([np.ones(count), scaling.high - start])
    anchor = anchor_of(problem, scaling)
    at = np.zeros(count + len(start))
    for _ in range(LINEAR_STEPS):
        rows, target = anchor.rows(start + at[count:])
        held = np.hstack([np.zeros((len(rows), count)), rows]), target
        there = base.residual + slopes @ at
        at = np.clip(at + linear_step(there, slopes, (low - at, high - at), scale, held), low, high)
    changes = dict(base.changes)
    for one, share in zip(chosen, at[:count], strict=True):
        changes |= _own(problem, one, float(share))
    return changes | scaling.physical(start + at[count:])


def _own(problem: Problem, one: Alone, share: float) -> dict[str, float]:
    """The candidate's own numbers with that share of its amplitudes; its shapes stay."""
    prefix, strengths = f"{one.effect.name()}.", set(amplitudes(one.effect, problem))
    found = {}
    for name, value in one.changes.items():
        if name.startswith(prefix):
            absent = float(problem.table.values[problem.table.position(name)])
            found[name] = absent + share * (value - absent) if name in strengths else value
    return found
