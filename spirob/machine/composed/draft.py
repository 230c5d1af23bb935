"""Drafts of a law beside a fitted model: terms with factors, to first order in the fitted numbers.

Each fold is predicted from the others and the held-out trials from all, as everywhere in the search
(`flexible`); a draft is judged by the same questions as an effect (`criteria`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from spirob.diagnosis.evidence import block_errors
from spirob.identify.descent import slopes_ahead
from spirob.identify.scaling import Scaling
from spirob.machine.composed.term import Term
from spirob.machine.composed.track import Ranges, Track, ranges_of
from spirob.machine.flexible import error, left_out_linear, products, step
from spirob.machine.inverse import InverseProblem
from spirob.machine.models import STEP
from spirob.machine.search import Search

TINY = 1e-9  # of a coordinate: room that a bound leaves at least
NOTHING = 1e-6  # of the residual: a column so small says nothing of it

LARGE = 1.5  # times the residual: a term that is larger is mostly cancelled by another


@dataclass(frozen=True)
class Draft:
    """Terms with the factors of their parts; errors as those of a `Model`.

    moved  by how much the coordinates of the fitted numbers move with it
    """

    terms: tuple[Term, ...]
    factors: tuple[np.ndarray, ...]
    moved: np.ndarray
    left: np.ndarray
    errors: np.ndarray
    heldout: np.ndarray

    @property
    def mean_square(self) -> float:
        """Of the folds left out."""
        return float(np.mean(self.left**2))

    @property
    def heldout_square(self) -> float:
        """Of the held-out trials."""
        return float(np.mean(self.heldout**2))

    @property
    def richness(self) -> int:
        """Numbers and memories."""
        return sum(term.richness for term in self.terms)


@dataclass(frozen=True)
class Point:
    """Numbers of the fitted model, without the law, and what follows to first order.

    residual, heldout  (N,) and (M,);  jacobian, slopes  of them by the coordinates of the numbers
    low, high          how far each coordinate may move
    """

    changes: dict[str, float]
    residual: np.ndarray
    jacobian: np.ndarray
    heldout: np.ndarray
    slopes: np.ndarray
    low: np.ndarray
    high: np.ndarray


def point_of(search: Search, names: Sequence[str], changes: Mapping[str, float]) -> Point:
    """The point of these changes, of which the named numbers are fitted."""
    scaling = Scaling(search.train.table, list(names))
    fixed = {name: value for name, value in changes.items() if name not in set(names)}
    at = np.clip(scaling.scaled(changes), scaling.low, scaling.high)
    inside = {**fixed, **scaling.physical(at)}

    def along(problem: InverseProblem) -> tuple[np.ndarray, np.ndarray]:
        value = problem(inside)
        return value, slopes_ahead(problem, scaling, at, fixed, value, STEP)

    low, high = np.minimum(scaling.low - at, -TINY), np.maximum(scaling.high - at, TINY)
    return Point(inside, *along(search.train), *along(search.heldout), low, high)


class Drafts:
    """All drafts beside a model at a point, and the columns of their terms.

    ranges  that teach the law, where they are known already
    """

    def __init__(
        self,
        search: Search,
        names: Sequence[str],
        changes: Mapping[str, float],
        ranges: Ranges | None = None,
    ):
        self.search, self.names = search, list(names)
        self.point = point_of(search, names, changes)
        self.track = Track.of(search.train, self.point.changes)
        self._held = Track.of(search.heldout, self.point.changes)
        self.ranges = ranges or ranges_of(self.track, search.train)
        self.folds = search.models.folds
        slopes = self.point.jacobian
        self._span = np.linalg.qr(slopes / (np.linalg.norm(slopes, axis=0) + 1e-300))[0]
        self._columns: dict[Term, np.ndarray] = {}

    def moved(self, draft: Draft) -> "Drafts":
        """The same at the numbers that a draft asks for beside itself."""
        scaling = Scaling(self.search.train.table, self.names)
        at = scaling.scaled(self.point.changes) + draft.moved
        fixed = {n: v for n, v in self.point.changes.items() if n not in set(self.names)}
        asked = scaling.physical(np.clip(at, scaling.low, scaling.high))
        return Drafts(self.search, self.names, {**fixed, **asked}, self.ranges)

    def made(self, terms: Sequence[Term]) -> Draft:
        """The draft of these terms."""
        base, residual = self.point.jacobian, self.point.residual
        columns = [self.columns(term) for term in terms]
        whole = np.hstack([base, *columns])
        bounds = self.bounds(whole.shape[1])
        left = left_out_linear(whole, residual, self.folds, *bounds)
        moved = step(products(whole, residual, self.folds), *bounds)
        held = [self._shown(self.search.heldout, self._held, term) for term in terms]
        after = self.point.heldout + np.hstack([self.point.slopes, *held]) @ moved
        ends = np.cumsum([base.shape[1], *(c.shape[1] for c in columns)])
        factors = [moved[a:b] for a, b in pairwise(ends)]
        train = self.search.train
        errors = block_errors(left, train.edges, train.block)
        own = moved[: base.shape[1]]
        return Draft(tuple(terms), tuple(factors), own, left, errors, after)

    def columns(self, term: Term) -> np.ndarray:
        """What the parts of a term make of the residual, (N, parts)."""
        if term not in self._columns:
            self._columns[term] = self.fresh(term)
        return self._columns[term]

    def fresh(self, term: Term) -> np.ndarray:
        """The same, of a term that is not kept."""
        return self._shown(self.search.train, self.track, term)

    def _shown(self, problem: InverseProblem, track: Track, term: Term) -> np.ndarray:
        changes = self.point.changes
        return np.column_stack(
            [problem.shown(-values, changes) for values in term.along(track, self.ranges)]
        )

    def error(self, beside: Sequence[Term], term: Term) -> float:
        """Mean square of the folds left out with one more term, without keeping its columns."""
        own = self.fresh(term)
        whole = np.hstack([self.point.jacobian, *(self.columns(t) for t in beside), own])
        sums = products(whole, self.point.residual, self.folds)
        return error(sums, *self.bounds(whole.shape[1])) / len(self.folds)

    def balanced(self, draft: Draft) -> bool:
        """Whether no term is much larger than all that there is to explain.

        Such terms cancel one another, and say nothing outside of the motion that taught them.  Each
        is taken beside what the fitted numbers can make of it.
        """
        size = np.linalg.norm(self.point.residual)
        for term, factors in zip(draft.terms, draft.factors, strict=True):
            shown = self.columns(term) @ factors
            if np.linalg.norm(shown - self._span @ (self._span.T @ shown)) > LARGE * size:
                return False
        return True

    def offers(self, found: Sequence[Term]) -> "Offers":
        """Terms to be added, with the products of all their columns."""
        return Offers(self, found)

    def bounds(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Of so many coefficients: those of the fitted numbers first, the others are free."""
        low, high = self.point.low, self.point.high
        free = np.full(count - len(low), np.inf)
        return np.concatenate([low, -free]), np.concatenate([high, free])


class Offers:
    """The terms of the grammar beside one model; the samples are gone through once."""

    def __init__(self, drafts: Drafts, found: Sequence[Term]):
        self.drafts = drafts
        base, residual = drafts.point.jacobian, drafts.point.residual
        columns = [drafts.fresh(term) for term in found]
        least = NOTHING * (float(np.sqrt(np.mean(residual**2))) + 1e-300)
        shown = [bool(np.all(np.sqrt(np.mean(c**2, axis=0)) > least)) for c in columns]
        self.terms = [t for t, one in zip(found, shown, strict=True) if one]
        kept = [c for c, one in zip(columns, shown, strict=True) if one]
        self._whole, self._own = np.hstack([base, *kept]), base.shape[1]
        self._sums = products(self._whole, residual, drafts.folds)
        ends = self._own + np.cumsum([0, *(c.shape[1] for c in kept)])
        self._cells = [range(a, b) for a, b in pairwise(ends)]

    def errors(self, beside: Sequence[Term]) -> np.ndarray:
        """Mean square of the folds left out with each term added, (terms,)."""
        drafts, known, sums = self.drafts, list(range(self._own)), self._sums
        if beside:
            further = np.hstack([drafts.columns(term) for term in beside])
            known += range(self._whole.shape[1], self._whole.shape[1] + further.shape[1])
            sums = self._with(further)
        found = []
        for own in self._cells:
            cells = [*known, *own, -1]
            part = sums[:, cells][:, :, cells]
            found.append(error(part, *drafts.bounds(len(cells) - 1)) / len(drafts.folds))
        return np.array(found)

    def _with(self, further: np.ndarray) -> np.ndarray:
        """The products with further columns, (N, b), which stand before the residual."""
        residual, folds = self.drafts.point.residual, self.drafts.folds
        ends = np.flatnonzero(np.diff(folds)) + 1
        parts = zip(
            *(np.split(a, ends) for a in (self._whole, residual[:, None], further)), strict=True
        )
        n, b = self._whole.shape[1], further.shape[1]
        sums = np.empty((len(self._sums), n + b + 1, n + b + 1))
        for k, (whole, last, more) in enumerate(parts):
            sums[k, :n, :n] = self._sums[k, :n, :n]
            sums[k, -1, :n] = sums[k, :n, -1] = self._sums[k, :n, -1]
            sums[k, -1, -1] = self._sums[k, -1, -1]
            sums[k, n:-1, :n] = more.T @ whole
            sums[k, :n, n:-1] = sums[k, n:-1, :n].T
            sums[k, n:-1, n:-1] = more.T @ more
            sums[k, n:-1, -1:] = more.T @ last
            sums[k, -1:, n:-1] = sums[k, n:-1, -1:].T
        return sums
