"""The coordinates in which a fit moves.

A motor shows, as current, what it has to hold over how strongly it pulls,

    i ≈ (J a + b ω + k g(q) + friction)/(η …),

so a fit moves in J/η, b/η, k/η, τ_d k/η and 1/η, in which the current is nearly linear; in the
numbers themselves, or their logarithms, it is not, and Gauss-Newton steps go astray as soon as a
missing effect has to change a number by a third.  Measured on the emulated arm with dry friction
hidden: 20 evaluations to the optimum, 80 in the numbers themselves, and only in these coordinates
do the linearised effects rank as they do when fitted in full.
"""

import re
from collections.abc import Mapping, Sequence

import numpy as np

from spirob.parameter import Parameter, Table

STRENGTH = "winch.efficiency"  # what divides every load
LOAD = re.compile(r"N|kg")  # units of what a motor has to hold


class Scaling:
    """Between physical values and coordinates u, each of them about as large as its number.

    u = ln(p/p_0)              a shape that spans decades
    u = (p - p_0)/size         any other number
    u = (p/p_0)·(η_0/η)        a load, which is positive;  (p/size)·(η_0/η) where it may vanish
    u = (p/p_0)(k/k_0)·(η_0/η) a number declared as a load by another one, `Parameter.times`
    u = η_0/η                  the efficiency itself

    The last three only where the efficiency is fitted too.
    """

    def __init__(self, table: Table, names: Sequence[str]):
        self.names = list(names)
        self._about = [table.about[n] for n in names]
        nominal = np.array([a.nominal for a in self._about])
        span = np.array([a.high - a.low for a in self._about])
        size = np.where(nominal != 0, np.abs(nominal), 0.1 * span)
        self._nominal, self._size = nominal, np.minimum(size, span)
        joint = STRENGTH in self.names
        self._strength = self.names.index(STRENGTH) if joint else -1
        self._load = np.array([joint and _is_load(n, table.about[n]) for n in names])
        self._times = [self._factor(a) if joint else -1 for a in self._about]
        self._ratio = self._load & np.array([a.low > 0 for a in self._about])
        self._decades = np.array([a.log for a in self._about])
        self._log = self._decades & ~self._load
        values = [float(table.values[table.position(n)]) for n in names]
        reach = [a.reach(v) for a, v in zip(self._about, values, strict=True)]
        self._low, self._high = np.array(reach).reshape(-1, 2).T
        self.low, self.high = self._box()

    @property
    def size(self) -> np.ndarray:
        """What counts as one of each number that does not span decades, (n,)."""
        return self._size

    def scaled(self, values: Mapping[str, float]) -> np.ndarray:
        """Coordinates of physical values."""
        return self._coordinates(np.array([values[n] for n in self.names]))

    def physical(self, u: np.ndarray) -> dict[str, float]:
        """Physical values of coordinates, cut to their bounds."""
        p = np.clip(self._values(u), self._low, self._high)
        return {n: float(v) for n, v in zip(self.names, p, strict=True)}

    def around(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates while the efficiency stays that of u, (n,) each.

        The box `low`, `high` holds those of every efficiency; between the two a number is cut to
        its bound, where the residual knows nothing of the coordinate.
        """
        if self._strength < 0:
            return self.low, self.high
        here = np.array(list(self.physical(u).values()))
        alone = np.eye(len(u), dtype=bool)
        ends = [
            [self._coordinates(np.where(one, bound, here))[k] for k, one in enumerate(alone)]
            for bound in (self._low, self._high)
        ]
        return np.min(ends, axis=0), np.max(ends, axis=0)

    def relative(self, u: np.ndarray) -> np.ndarray:
        """Slopes of the relative numbers by the coordinates, (n, n).

        Relative is ln p for a number that spans decades, p over its size for any other.
        """
        step = 1e-6
        slopes = [
            (self._relative(u + step * e) - self._relative(u - step * e)) / (2 * step)
            for e in np.eye(len(u))
        ]
        return np.column_stack(slopes)

    def slopes(self, u: np.ndarray) -> np.ndarray:
        """Slopes of the numbers, in their own units, by the coordinates, (n, n)."""
        size = np.where(self._decades, self._values(u), self._size)
        return np.asarray(size[:, None] * self.relative(u))

    def spread(self, u: np.ndarray, covariance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Ends of the 95 % intervals of the physical values, cut to their bounds, (n,) each.

        Propagated to first order, on the logarithm of numbers that span decades.
        """
        slopes = self.relative(u)
        half = 1.96 * np.sqrt(np.maximum(0.0, np.diag(slopes @ covariance @ slopes.T)))
        ends = [self._relative(u) - half, self._relative(u) + half]
        low, high = (
            np.where(self._decades, np.exp(np.minimum(e, 700.0)), e * self._size) for e in ends
        )
        return np.clip(low, self._low, self._high), np.clip(high, self._low, self._high)

    def _relative(self, u: np.ndarray) -> np.ndarray:
        p = self._values(u)
        return np.where(self._decades, np.log(np.maximum(p, 1e-300)), p / self._size)

    def _factor(self, about: Parameter) -> int:
        return self.names.index(about.times) if about.times in self.names else -1

    def _own(self, p: np.ndarray) -> np.ndarray:
        with np.errstate(divide="ignore", invalid="ignore"):
            logs = np.log(p / self._nominal)
            shift = np.where(self._load, 0.0, self._nominal)
            plain = np.where(self._ratio, p / self._nominal, (p - shift) / self._size)
        return np.where(self._log, logs, plain)

    def _coordinates(self, p: np.ndarray) -> np.ndarray:
        u = self._own(p)
        if self._strength < 0:
            return u
        ratio = p / np.where(self._nominal == 0, 1.0, self._nominal)
        strength = ratio[self._strength]
        u = np.where(self._load, u / strength, u)
        for k, times in enumerate(self._times):
            if times >= 0:
                u[k] *= ratio[times]
        u[self._strength] = 1.0 / strength
        return u

    def _values(self, u: np.ndarray) -> np.ndarray:
        u = np.array(u, dtype=float)
        if self._strength >= 0:
            strength = 1.0 / max(float(u[self._strength]), 1e-9)
            u[self._strength] = strength
            u = np.where(self._load, u * strength, u)
            factors = {t: max(float(u[t]), 1e-9) for t in self._times if t >= 0}
            for k, times in enumerate(self._times):
                if times >= 0:
                    u[k] /= factors[times]
            ratio = self._ratio.copy()
            ratio[self._strength] = True
        else:
            ratio = self._ratio
        shift = np.where(self._load, 0.0, self._nominal)
        plain = np.where(ratio, self._nominal * u, shift + u * self._size)
        with np.errstate(over="ignore"):
            return np.where(self._log, self._nominal * np.exp(np.where(self._log, u, 0.0)), plain)

    def _box(self) -> tuple[np.ndarray, np.ndarray]:
        """The smallest box of coordinates that holds the box of physical values."""
        ends = np.array([self._own(self._low), self._own(self._high)])
        if self._strength >= 0:
            ratios = np.array([self._low, self._high]) / np.where(
                self._nominal == 0, 1.0, self._nominal
            )
            inverse = 1.0 / ratios[:, self._strength]
            for k in np.flatnonzero(self._load):
                corners = np.outer(ends[:, k], inverse)
                if self._times[k] >= 0:
                    corners = np.outer(corners, ratios[:, self._times[k]])
                ends[:, k] = corners.min(), corners.max()
            ends[:, self._strength] = inverse
        return ends.min(axis=0), ends.max(axis=0)


def _is_load(name: str, about: Parameter) -> bool:
    """Whether a motor has to hold it: a force, a torque, a mass, or what is declared as one."""
    if name == STRENGTH or "A" in about.unit:
        return False
    return bool(about.times or LOAD.search(about.unit))
