"""Where effort and motion lie best over one another, whatever law the machine may have besides.

    argmin over δ of  min over effects of  min over p of |m(p) - e(t + δ)|²,   p in their bounds

m is what the fitted numbers and one effect of the library ask for on the measured motion, linear in
its amplitudes; e is the measured effort.  A delay turns inertia into friction and friction into a
spring, so it is told apart from what is missing only beside what may be missing, and by bounds: an
inertia or a friction below zero is none.  Shifting the effort changes no column, so all delays
cost little more than one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spirob.effects import Effect
from spirob.machine.alignment import FARTHEST, usual
from spirob.machine.flexible import RIDGE, step
from spirob.machine.inverse import InverseProblem
from spirob.machine.models import DELAY, Model
from spirob.machine.screening import Screening, room
from spirob.machine.shapes import counts_periods, starts

FINE = 3  # steps of the search in the delay that is usual
ENOUGH = 4000  # rows to look for it
FEWEST = 50  # rows below which nothing is looked for
LOOKS = 9  # delays at which the orders of waves are looked for
TOLD = 0.1  # of the squared error: a delay beyond the usual takes more than that


@dataclass(frozen=True)
class _Law:
    """Products of a law's columns with one another (n, n) and with the residuals (n, K)."""

    gram: np.ndarray
    side: np.ndarray
    low: np.ndarray
    high: np.ndarray

    def least(self) -> np.ndarray:
        """Fall of the squared residual at each delay, were there no bounds, (K,)."""
        size = np.sqrt(np.diagonal(self.gram)) + 1e-300
        scaled = self.gram / np.outer(size, size) + RIDGE * np.eye(len(size))
        goal = self.side / size[:, None]
        return np.asarray(np.sum(goal * np.linalg.solve(scaled, goal), axis=0))

    def within(self, k: int) -> float:
        """The same at one delay, within bounds."""
        side = self.side[:, k]
        sums = np.block([[self.gram, side[:, None]], [side[None], np.zeros((1, 1))]])
        moved = step(sums[None], self.low, self.high)
        return float(-2.0 * moved @ side - moved @ self.gram @ moved)


def place(
    problem: InverseProblem, model: Model, folds: np.ndarray, effects: Sequence[type[Effect]]
) -> float:
    """Seconds by which the effort trails the motion, 0 where that is no more than usual.

    model    fitted, at whatever delay;  effects  of which one may be missing of it
    """
    period = max(r.period for r in problem.recordings)
    most, here = usual(period), model.fit.changes.get(DELAY, 0.0)
    pace = max(period, most / FINE)
    delays = pace * np.arange(-int(FARTHEST / pace), int(FARTHEST / pace) + 1)
    rows, efforts = problem.later(delays - here, max(1, len(model.left) // ENOUGH))
    if len(rows) < FEWEST:
        return 0.0
    residuals = (model.fit.residual + problem.measured())[rows, None] - efforts
    laws = _laws(Screening(problem, model.fit, folds), rows, residuals, effects)
    left = np.sum(residuals**2, axis=0) - _falls(laws)
    best, near = int(np.argmin(left)), float(np.min(left[np.abs(delays) <= most]))
    return float(delays[best]) if left[best] < (1.0 - TOLD) * near else 0.0


def _falls(laws: Sequence[_Law]) -> np.ndarray:
    """Greatest fall of the squared residual by any of the laws at each delay, (K,)."""
    free = np.array([law.least() for law in laws])
    falls = np.full(free.shape[1], -np.inf)
    for k, own in enumerate(free.T):
        for which in np.argsort(-own):
            if own[which] <= falls[k]:  # bounds can only take from it
                break
            falls[k] = max(falls[k], laws[which].within(k))
    return falls


def _laws(
    screening: Screening, rows: np.ndarray, residuals: np.ndarray, effects: Sequence[type[Effect]]
) -> list[_Law]:
    """The fitted numbers alone, and with each effect in several shapes."""
    problem = screening.problem
    own = [k for k, name in enumerate(screening.names) if name != DELAY]
    base = screening.jacobian[np.ix_(rows, own)]
    low, high = (edge[own] for edge in screening.room)
    made = [_Law(base.T @ base, base.T @ residuals, low, high)]
    signals = {name: values[rows] for name, values in screening.signals.items()}
    looks = residuals[:, :: max(1, residuals.shape[1] // LOOKS)].T
    for effect in effects:
        about = {f: problem.table.about[f"{effect.name()}.{f}"] for f in effect.parameters()}
        waves = any(counts_periods(effect, f) for f in about if f not in effect.neutral)
        known: dict[tuple[object, ...], np.ndarray] = {}
        for residual in looks if waves else looks[:1]:
            for shape in starts(effect, about, residual, signals):
                probed = screening.probe(effect, shape, known)
                columns = np.hstack([base, probed.columns[rows]])
                edges = np.hstack([low, probed.low]), np.hstack([high, probed.high])
                made.append(_Law(columns.T @ columns, columns.T @ residuals, *edges))
    return made
