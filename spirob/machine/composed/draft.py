"""Drafts of a law beside a fitted model: terms with factors, to first order in the fitted numbers.

Each fold is predicted from the others and the held-out trials from all, as everywhere in the search
(`flexible`); a draft is judged by the same questions as an effect (`criteria`).

One draft is a question: is a law of dry friction bent as the machine's is?  A free curve over the
speed tells,

    τ = -Σ_k c_k·w_k(√(|v|/v_max))·sign(v),   w_k bumps evenly apart, none of them at standstill

beside the fitted law and numbers.  Near standstill every law turns round in its own way, which says
nothing of its level.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from spirob.diagnosis.criteria import block_errors
from spirob.diagnosis.model import Model, Scored, is_dry
from spirob.diagnosis.regression import error, joined, left_out_linear, products, step
from spirob.machine.composed.ground import Ground, Side, ground_of
from spirob.machine.composed.terms import LOST, WAY, Shape, Term
from spirob.machine.inverse.kernel_loop import Cache
from spirob.machine.search.models import RigSearch

NOTHING = 1e-6  # of the residual: a column so small says nothing of it

LARGE = 1.5  # times the residual: a term that is larger is mostly cancelled by another

BUMPS = 5  # of a free curve over the speed


@dataclass(frozen=True)
class Draft(Scored):
    """Terms with the factors of their columns.

    moved  by how much the coordinates of the fitted numbers move with it
    """

    terms: tuple[Term, ...]
    factors: tuple[np.ndarray, ...]
    moved: np.ndarray
    left: np.ndarray
    errors: np.ndarray
    heldout: np.ndarray

    @property
    def richness(self) -> int:
        """Numbers and memories."""
        return sum(term.richness for term in self.terms)


class Drafts:
    """All drafts beside a model, and the columns of their terms."""

    def __init__(self, ground: Ground):
        self.ground, self.ranges, self.folds = ground, ground.ranges, ground.folds
        slopes = ground.train.slopes
        self._span = np.linalg.qr(slopes / (np.linalg.norm(slopes, axis=0) + 1e-300))[0]
        self._columns: dict[Term, np.ndarray] = {}
        self._known: Cache[tuple[np.ndarray, np.ndarray]] = Cache(1)

    def moved(self, draft: Draft) -> "Drafts":
        """The same at the numbers that a draft asks for beside itself."""
        return Drafts(self.ground.moved(draft.moved))

    def made(self, terms: Sequence[Term]) -> Draft:
        """The draft of these terms."""
        own, other = self.ground.train, self.ground.heldout
        base, residual = own.slopes, own.residual
        columns = [self.columns(term) for term in terms]
        whole = np.hstack([base, *columns])
        bounds = self.bounds(whole.shape[1])
        left = left_out_linear(whole, residual, self.folds, *bounds)
        moved = step(products(whole, residual, self.folds), *bounds)
        held = [self._shown(other, term) for term in terms]
        after = other.residual + np.hstack([other.slopes, *held]) @ moved
        ends = np.cumsum([base.shape[1], *(c.shape[1] for c in columns)])
        factors = [moved[a:b] for a, b in pairwise(ends)]
        errors = block_errors(left, self.ground.edges, self.ground.block)
        numbers = moved[: base.shape[1]]
        return Draft(tuple(terms), tuple(factors), numbers, left, errors, after)

    def columns(self, term: Term) -> np.ndarray:
        """What the parts of a term make of the residual, (N, parts)."""
        if term not in self._columns:
            self._columns[term] = self.fresh(term)
        return self._columns[term]

    def fresh(self, term: Term) -> np.ndarray:
        """The same, of a term that is not kept."""
        return self._shown(self.ground.train, term)

    def _shown(self, side: Side, term: Term) -> np.ndarray:
        parts = term.along(side.track, self.ranges)
        if term.drives:
            columns = np.column_stack([side.shown(-v) for v in parts])
            return columns + np.outer(side.residual, self._shares(term, side, parts))
        if len(parts) == 1:  # what has several parts is alike in all motors
            parts = [parts[0] * own for own in side.motors] or parts
        return np.column_stack([side.shown(-v) for v in parts])

    def _shares(self, term: Term, side: Side, parts: Sequence[np.ndarray]) -> np.ndarray:
        """By how much the parts of what a drive loses are in proportion to its effort, (parts,).

        parts  of the term along the trials of a side

        So much of the effort, which is the model less the residual, is taken out of a column: it
        would explain effort by effort.  The model may keep it: what no fitted number makes of it, a
        known weight, tells what a drive loses in proportion, too.
        """
        own, made = self.ground.train, self._made
        known = parts if side is own else term.along(own.track, self.ranges)
        lost = np.array([np.dot(own.thinned(part), made) for part in known])
        return lost / np.dot(made, made) / self.ranges.strong

    @cached_property
    def _made(self) -> np.ndarray:
        """What the drive makes along the fitted trials, over its strongest, (N,)."""
        own = self.ground.train
        return own.thinned(Term((LOST,)).along(own.track, self.ranges)[0])

    def error(self, beside: Sequence[Term], term: Term) -> float:
        """Mean square of the folds left out with one more term, without keeping its columns."""
        residual, folds = self.ground.train.residual, self.folds

        def known() -> tuple[np.ndarray, np.ndarray]:
            columns = np.hstack([self.ground.train.slopes, *(self.columns(t) for t in beside)])
            return columns, products(columns, residual, folds)

        columns, sums = self._known(tuple(beside), known)
        whole = joined(sums, columns, self.fresh(term), residual, folds)
        return error(whole, *self.bounds(whole.shape[1] - 1)) / len(folds)

    def balanced(self, draft: Draft) -> bool:
        """Whether no term is much larger than all that there is to explain.

        Such terms cancel one another, and say nothing outside of the motion that taught them.  Each
        is taken beside what the fitted numbers can make of it.
        """
        size = np.linalg.norm(self.ground.train.residual)
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
        low, high = self.ground.low, self.ground.high
        free = np.full(count - len(low), np.inf)
        return np.concatenate([low, -free]), np.concatenate([high, free])


class Offers:
    """The terms of the grammar beside one model; the samples are gone through once."""

    def __init__(self, drafts: Drafts, found: Sequence[Term]):
        self.drafts = drafts
        base, residual = drafts.ground.train.slopes, drafts.ground.train.residual
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
            residual, folds = drafts.ground.train.residual, drafts.folds
            sums = joined(sums, self._whole, further, residual, folds)
        found = []
        for own in self._cells:
            cells = [*known, *own, -1]
            part = sums[:, cells][:, :, cells]
            found.append(error(part, *drafts.bounds(len(cells) - 1)) / len(drafts.folds))
        return np.array(found)


def freed(search: RigSearch, model: Model) -> Draft:
    """The model with a level that may follow any curve over the speed."""
    parts = tuple(
        f"way*(0.5 + 0.5*cos(pi*Max(-1.0, Min(1.0, {float(BUMPS)!r}*share**0.5 - {float(k)!r}))))"
        for k in range(1, BUMPS + 1)
    )
    ground = ground_of(search, list(model.fit.estimates), model.fit.changes)
    return Drafts(ground).made((Term((Shape(WAY, "speed", parts),)),))


def is_bent(search: RigSearch, model: Model) -> bool:
    """Whether a free curve halves what is left of a model with dry friction, by what counts."""
    if not any(is_dry(effect) for effect in model.effects):
        return False
    free, worth = freed(search, model), search.worth
    return worth.matters(model, free) and worth.halves(model, free)
