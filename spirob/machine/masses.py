"""Is a known inertia, or a body of a model file, many times off, as the effort says?

What a mass asks of the drive is linear in it.  A factor of one body, or of all that the description
asks for, is told where it is nearer to ten than to one, and where it makes inertia and friction
beside it fit; otherwise a payload, a spring or a law may be what is missing.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from spirob.diagnosis.model import Model
from spirob.machine.body import RigidBody
from spirob.machine.checks import TENFOLD
from spirob.machine.inverse import InverseProblem
from spirob.machine.models import RigSearch
from spirob.machine.odd_logs import FAMILIAR, RESISTING, beside_plain, plain_columns

HALF = 0.5  # of the squared error: a factor takes more than that, of any other model, too


@dataclass(frozen=True)
class _Tried:
    """A factor of one body, or of the whole model file, and the share that is explained with it."""

    body: str
    factor: float
    share: float

    def said(self, as_described: float) -> str:
        """Both figures."""
        most, least = f"{self.share:.0%}", f"{max(0.0, as_described):.0%}"
        if not self.body:
            return (
                f"The effort is {self.factor:.3g} times what the description asks for: with that "
                f"factor it explains {most} of the variance, as described {least}."
            )
        return (
            f"With body '{self.body}' {self.factor:.3g} times as heavy as in its model file "
            f"{most} of the effort's variance is explained, as described {least}."
        )


def out_of_scale(search: RigSearch, chosen: Model) -> str:
    """What of a description is many times off, where no law found fits as well; or empty."""
    problem = search.models.train
    rig = problem.rig
    known = problem.body is not None or (rig.known.get("inertia", 0.0) > 0.0)
    if not known or "scale" in rig.fit:
        return ""
    if not search.worth.possible(chosen, 0.0, search.models.promised):
        return ""
    zero = {name: 0.0 for name in search.models.names if name != "rig.scale"}
    measured = problem.measured()
    asked = problem(zero) + measured
    as_described = _resisted(problem, measured, asked, np.zeros((len(asked), 0)))[0]
    whole = _tried(problem, measured, asked, "", asked)
    bodies = [
        _tried(problem, measured, asked, name, column)
        for name, column in (_weighed(problem, problem.body, zero) if problem.body else ())
    ]
    best = max([whole, *bodies], key=lambda tried: tried.share)
    if 1.0 - best.share > HALF * (1.0 - whole.share):
        best = whole
    found = 1.0 - chosen.mean_square / max(float(np.var(measured)), 1e-300)
    enough = 1.0 - best.share <= HALF * (1.0 - max(as_described, found))
    far = best.factor > 0.0 and not 1.0 / TENFOLD < best.factor < TENFOLD
    return best.said(as_described) if far and enough and best.share >= FAMILIAR else ""


def _tried(
    problem: InverseProblem, measured: np.ndarray, asked: np.ndarray, name: str, column: np.ndarray
) -> _Tried:
    share, (more,) = _resisted(problem, measured, asked, column[:, None])
    return _Tried(name, 1.0 + float(more), share)


def _resisted(
    problem: InverseProblem, measured: np.ndarray, asked: np.ndarray, columns: np.ndarray
) -> tuple[float, np.ndarray]:
    """The share of the effort explained by `asked`, by what resists, a force and columns (N, k).

    Also their numbers, (k,).  Where there is no body, whose inertia is another and
    which knows its weight, a known inertia is all of it, and a weight and a spring are free.
    """
    plain, resisting = plain_columns(problem)[: RESISTING + 1], RESISTING
    if problem.body is None:
        plain, resisting = plain_columns(problem)[1:], RESISTING - 1
    numbers, left = beside_plain(measured - asked, plain, resisting, columns)
    return 1.0 - left / max(float(np.var(measured)), 1e-300), numbers


def _weighed(
    problem: InverseProblem, body: RigidBody, changes: dict[str, float]
) -> Iterator[tuple[str, np.ndarray]]:
    """Each body whose mass the drive feels, with what that asks of the effort, (N,)."""
    pieces = [piece for recording in problem.recordings for piece in recording.pieces]
    for name in body.heavy:
        doubled = np.concatenate([body.doubled(name, piece) for piece in pieces])
        column = -problem.shown(doubled - problem.asked.motion.body["load"], changes)
        if np.any(column):
            yield name, column
