"""First-order screening on an inverse problem: which absent effects explain what is left?

Each effect becomes a few columns, the residual's derivatives by its amplitudes, for several starts
of its shape; the residual is regressed on them together with the columns of everything fitted, and
each fold is predicted from the others.  Pairs are tried on the same columns: a true effect may
raise the error when it is added alone.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from spirob.diagnosis.model import Offer
from spirob.diagnosis.regression import error, products, step
from spirob.effects import Effect
from spirob.identify.fit import Fit
from spirob.identify.scaling import Scaling
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.shapes import places, shaping, starts
from spirob.parameter import Parameter, Table

GRIDDED, WALK = 2, 6  # numbers of a shape that a grid still covers; places on a walk along one
PROBE = 0.2  # of an amplitude's nominal value


Columns = dict[tuple[object, ...], np.ndarray]  # amplitude, shape numbers that matter to it


@dataclass(frozen=True)
class Probed:
    """An effect of a certain shape, added by a part of each amplitude.

    shape    field -> value;  columns  (N, amplitudes) change of the residual for `sizes` of each
    low, high  bounds of their coefficients
    """

    effect: type[Effect]
    shape: dict[str, float]
    columns: np.ndarray
    low: np.ndarray
    high: np.ndarray
    sizes: np.ndarray


@dataclass(frozen=True)
class Tried:
    """A probed effect, regressed on: products of all columns, and the error of folds left out."""

    probed: Probed
    sums: np.ndarray
    error: float


class Screening:
    """Screening around one fitted model of a problem; `folds` (N,) is the label of each sample.

    An effect is tried once, however often it is asked for.
    """

    def __init__(self, problem: InverseProblem, at: Fit, folds: np.ndarray):
        self.problem, self.residual, self.jacobian = problem, at.residual, at.jacobian
        self.changes, self.folds, self.names = dict(at.changes), folds, list(at.estimates)
        self.room = room(problem.table, at)
        self.signals = {**problem.signals(), "effort": problem.measured()}
        sizes = np.linalg.norm(at.jacobian, axis=0) + 1e-300
        self._q = np.linalg.qr(at.jacobian / sizes)[0]
        self._tried: dict[str, Offer] = {}

    def offers(self, effects: Sequence[type[Effect]]) -> list[Offer]:
        """The effects, each at its best shape, best first."""
        for effect in self.untried(effects):
            self._tried[effect.name()] = self._offer(effect)
        return sorted((self._tried[e.name()] for e in effects), key=lambda offer: offer.error)

    def untried(self, effects: Sequence[type[Effect]]) -> list[type[Effect]]:
        """Those of the effects that were not asked for before."""
        return [e for e in effects if e.name() not in self._tried]

    def pairs(self, offers: Sequence[Offer]) -> list[tuple[float, Offer, Offer]]:
        """All pairs of offers with the error of the two together, best first."""
        probed = [self.probe(o.effect, self._shape(o), {}) for o in offers]
        sums = self._sums(*(p.columns for p in probed))
        own = self.jacobian.shape[1]
        ends = own + np.cumsum([0, *(len(p.low) for p in probed)])
        found = []
        for one, two in combinations(range(len(offers)), 2):
            cells = [*range(own), *range(ends[one], ends[one + 1])]
            cells += [*range(ends[two], ends[two + 1]), -1]
            error = self._error(sums[:, cells][:, :, cells], probed[one], probed[two])
            found.append((error, offers[one], offers[two]))
        return sorted(found, key=lambda entry: entry[0])

    def _offer(self, effect: type[Effect]) -> Offer:
        """The effect at its best shape."""
        best = self._best(effect)
        probed, table = best.probed, self.problem.table
        coefficients = step(best.sums, *self._bounds(probed))[self.jacobian.shape[1] :]
        values = {f"{effect.name()}.{f}": v for f, v in probed.shape.items()}
        for field, size, coefficient in zip(
            effect.neutral, probed.sizes, coefficients, strict=True
        ):
            full = f"{effect.name()}.{field}"
            about, zero = table.about[full], float(table.values[table.position(full)])
            values[full] = float(np.clip(zero + coefficient * size, about.low, about.high))
        outside = probed.columns - self._q @ (self._q.T @ probed.columns)
        new = float(np.linalg.norm(outside) / (np.linalg.norm(probed.columns) + 1e-300))
        return Offer(effect, values, best.error, new)

    def _best(self, effect: type[Effect]) -> Tried:
        table = self.problem.table
        about = {f: table.about[f"{effect.name()}.{f}"] for f in effect.parameters()}
        if len(about) - len(effect.neutral) > GRIDDED:
            return self._walked(effect, about)
        shapes = starts(effect, about, self.residual, self.signals)
        known: Columns = {}
        return min((self._trial(effect, s, known) for s in shapes), key=lambda trial: trial.error)

    def _walked(self, effect: type[Effect], about: Mapping[str, Parameter]) -> Tried:
        """The best shape by walking along one number after the other, from the nominal ones."""
        shape = {f: p.nominal for f, p in about.items() if f not in effect.neutral}
        known: Columns = {}
        best, seen = self._trial(effect, shape, known), {tuple(shape.values())}
        for field in [*shape, *shape]:
            for value in places(effect, about[field], field, WALK, self.residual, self.signals):
                shape = {**best.probed.shape, field: value}
                if (at := tuple(shape.values())) in seen:
                    continue
                seen.add(at)
                tried = self._trial(effect, shape, known)
                if tried.error < best.error:
                    best = tried
        return best

    def _trial(self, effect: type[Effect], shape: Mapping[str, float], known: Columns) -> Tried:
        probed = self.probe(effect, shape, known)
        sums = self._sums(probed.columns)
        return Tried(probed, sums, self._error(sums, probed))

    def probe(self, effect: type[Effect], shape: Mapping[str, float], known: Columns) -> Probed:
        """The columns of a shape; those that are `known` from another one are taken from there."""
        table, name = self.problem.table, effect.name()
        at_shape = {f"{name}.{f}": v for f, v in shape.items()}
        columns, low, high, sizes = [], [], [], []
        for field in effect.neutral:
            full = f"{name}.{field}"
            about, zero = table.about[full], float(table.values[table.position(full)])
            size = about.nominal - zero or 0.02 * (about.high - zero)
            matters = shaping(effect, field)  # type: ignore[arg-type] # a class is hashable
            key: tuple[str | float, ...] = (field, *(shape[f] for f in matters))
            if key not in known:
                point = {**self.changes, **at_shape, full: zero + PROBE * size}
                known[key] = self.problem.added(effect, point, self.residual) / PROBE
            columns.append(known[key])
            sizes.append(size)
            edges = sorted(((about.low - zero) / size, (about.high - zero) / size))
            low.append(min(edges[0], -1e-9))
            high.append(max(edges[1], 1e-9))
        bounds = np.array(low), np.array(high)
        return Probed(effect, dict(shape), np.column_stack(columns), *bounds, np.array(sizes))

    def _shape(self, offer: Offer) -> dict[str, float]:
        name, fields = offer.effect.name(), offer.effect.parameters()
        return {f: offer.values[f"{name}.{f}"] for f in fields if f not in offer.effect.neutral}

    def _sums(self, *columns: np.ndarray) -> np.ndarray:
        return products(np.hstack([self.jacobian, *columns]), self.residual, self.folds)

    def _bounds(self, *probed: Probed) -> tuple[np.ndarray, np.ndarray]:
        low, high = self.room
        return np.hstack([low, *(p.low for p in probed)]), np.hstack(
            [high, *(p.high for p in probed)]
        )

    def _error(self, sums: np.ndarray, *probed: Probed) -> float:
        return error(sums, *self._bounds(*probed)) / len(self.residual)


def room(table: Table, at: Fit) -> tuple[np.ndarray, np.ndarray]:
    """How far each fitted number may move from where it is, in the coordinates of its slopes."""
    scaling = Scaling(table, list(at.estimates))
    u = scaling.scaled(at.changes)
    return np.minimum(scaling.low - u, -1e-9), np.maximum(scaling.high - u, 1e-9)
