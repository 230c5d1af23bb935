"""What a piece of a log begins with and its motion does not tell: a swing, a filter's content.

A load on an elastic gear swings already where a log begins in motion, or goes on after a gap.
Such a state decays, but what it does until then is no error of the model: it is taken out as it
fits best, like any unknown start.  How large a state is likely to be follows from what the law
does along the whole log, so that no law explains by its starts what it does not explain otherwise.
"""

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from spirob.effects import Effect
from spirob.machine.cache import Cache
from spirob.machine.inverse_equations import ADDED, HINGE, READ, AskedEffort
from spirob.machine.kernel_loop import is_pipe
from spirob.machine.motion import late

KEPT = 8  # laws whose swings are kept
LITTLE = 1e-6  # of the mean square, where nothing is known of the noise yet
LEAST = 1e-300  # mean square, so that nothing can be divided by nothing


class Swings:
    """The free states of the laws along the trials of one role.

    compared  of an effort at every sample, (n,), what is compared, (N,)
    ends      (pieces + 1,) where the pieces end among these
    """

    def __init__(
        self, asked: AskedEffort, compared: Callable[[np.ndarray], np.ndarray], ends: np.ndarray
    ):
        self.asked, self._compared = asked, compared
        self._pieces = list(pairwise(ends))
        self._known: Cache[np.ndarray] = Cache(KEPT)

    def taken(self, residual: np.ndarray, p: np.ndarray) -> np.ndarray:
        """A residual, (N,), without what its pieces begin with."""
        for effect in (e for port in (HINGE, *ADDED, *READ) for e in self.asked.present(port, p)):
            if effect.free:
                law, *free = self._columns(effect, p)
                residual = self._without(residual, law, np.array(free))
        return residual

    def _columns(self, effect: type[Effect], p: np.ndarray) -> np.ndarray:
        """What a law does to the residual, and 1 of each free state of a piece in it, (1 + s, N).

        They are kept: most derivatives move numbers of others.
        """
        own = self.asked.own(p)
        key = (effect.name(), own["scale"], own["delay"], *self.asked.values(effect, p).values())

        def made() -> np.ndarray:
            return np.array([self._compared(one) for one in self._efforts(effect, p)])

        return self._known(key, made)

    def _efforts(self, effect: type[Effect], p: np.ndarray) -> list[np.ndarray]:
        asked, motion, own = self.asked, self.asked.motion, self.asked.own(p)
        signals = asked.signals(motion, asked.load(motion, p), p)
        if is_pipe(effect):
            share, does = 1.0, asked.run(effect, p, motion, signals, motion.effort) - motion.effort
        else:
            share, does = -1.0 / own["scale"], asked.torque(effect, p, motion, signals)
        found = [does, *asked.swung(effect, p, motion)]
        return [late(share * one, own["delay"], motion) for one in found]

    def _without(self, residual: np.ndarray, law: np.ndarray, free: np.ndarray) -> np.ndarray:
        """A residual without what the free states of a law, (s, N), explain of each piece.

        Where a piece begins they do about as much as the law does; the noise is what is left.
        """
        sizes = np.max(np.abs(free), axis=1, keepdims=True)
        columns = free * (np.sqrt(np.mean(law**2)) / np.where(sizes > 0.0, sizes, 1.0))
        left, noise = residual, LITTLE * float(np.mean(residual**2))
        for _ in range(2):
            parts = [_left(residual[a:b], columns[:, a:b], noise) for a, b in self._pieces]
            left = np.concatenate(parts)
            noise = float(np.mean(left**2))
        return left


def _left(residual: np.ndarray, columns: np.ndarray, noise: float) -> np.ndarray:
    """What columns (s, n), of size 1, leave of a residual (n,) in noise of this mean square."""
    gram = columns @ columns.T + max(noise, LEAST) * np.eye(len(columns))
    return np.asarray(residual - np.linalg.solve(gram, columns @ residual) @ columns)
