"""What a log begins with and its motion does not tell: a swing, a filter's content, heat.

A load on an elastic gear swings already where a log begins in motion, or goes on after a gap; a
motor is warm where a log is the end of a longer run.  Such a state decays, but what it does until
then is no error of the model: it is taken out as it fits best, like any unknown start.  How large a
state is likely to be follows from what the law does along the whole log, so that no law explains by
its starts what it does not explain otherwise.

A motor begins no colder than the numbers of the rig are for, and no warmer than twice the currents
of the log would make it in the end.  Where another scale and no heat explain as much of a log, as
where the motor cools for much longer than that lasts, it is taken for cold.
"""

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from spirob.effects import Effect
from spirob.machine.inverse.equations import ADDED, BEFORE, HINGE, READ, AskedEffort
from spirob.machine.inverse.kernel_loop import Cache, is_pipe
from spirob.machine.inverse.motion import late

KEPT = 8  # laws whose swings are kept
LITTLE = 1e-6  # of the mean square, where nothing is known of the noise yet
TINY = float(np.finfo(float).tiny)  # below it a quotient overflows
SMALL = 1e-3  # of a state of a pipe, whose effect is taken to first order
SURELY = 0.9  # of the squared error that another scale leaves: heat leaves less
HOT = 4.0  # times the heat, of twice the current
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
        follows = asked.motion.follows or [False] * len(self._pieces)
        first = [k for k, goes_on in enumerate(follows) if not goes_on]
        self._logs = list(pairwise(ends[[*first, -1]]))
        self._along = list(pairwise(asked.motion.starts[[*first, -1]]))
        self._known: Cache[np.ndarray] = Cache(KEPT)

    def taken(self, residual: np.ndarray, p: np.ndarray, effort: np.ndarray) -> np.ndarray:
        """A residual, (N,), without what its pieces begin with, and the drive with its logs.

        effort  that the model asks for, unfiltered, (n,)
        """
        for effect in self._free(p, HINGE, *ADDED, *READ):
            law, *free = self._columns(effect, p)
            residual = self._without(residual, law, np.array(free))
        for effect in self._free(p, *BEFORE):
            share, more = self._warmed(effect, p, effort)
            warm, cold = self._compared(more), self._compared(effort * share)
            heat = self._compared(effort) - cold
            parts = [[one[a:b] for one in (residual, warm, cold, heat)] for a, b in self._logs]
            residual = np.concatenate([_begun_warm(*part) for part in parts])
        return residual

    def _free(self, p: np.ndarray, *ports: str) -> list[type[Effect]]:
        return [e for port in ports for e in self.asked.present(port, p) if e.free]

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

    def _warmed(
        self, effect: type[Effect], p: np.ndarray, effort: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The share of the torque that a warming drive keeps, and what more it needs, (n,) each.

        That is more of an effort, (n,), if it begins as warm as its log would make it in the end.
        """
        asked, motion, one = self.asked, self.asked.motion, np.ones_like(effort)
        seen = asked.signals(motion, asked.load(motion, p), p)
        seen |= {"motor.current": motion.effort, "motor.command": motion.effort}
        (name,) = effect.free
        share = asked.run(effect, p, motion, seen, one)
        begun = asked.run(effect, p, motion, seen, one, {name: effect.state[name] + SMALL})
        grows = (share - begun) / (SMALL * share)
        for a, b in self._along:
            stays = grows[b - 1] / grows[a]
            grows[a:b] *= (1.0 / share[b - 1] - 1.0) / max(1.0 - stays, SMALL) / grows[a]
        return share, effort * grows

    def _without(self, residual: np.ndarray, law: np.ndarray, free: np.ndarray) -> np.ndarray:
        """A residual without what the free states of a law, (s, N), explain of each piece.

        Where a piece begins they do about as much as the law does; the noise is what is left.
        """
        sizes = np.max(np.abs(free), axis=1, keepdims=True)
        columns = free * (np.sqrt(np.mean(law**2)) / np.where(sizes > TINY, sizes, 1.0))
        left, noise = residual, LITTLE * float(np.mean(residual**2))
        for _ in range(2):
            parts = [_left(residual[a:b], columns[:, a:b], noise) for a, b in self._pieces]
            left = np.concatenate(parts)
            noise = float(np.mean(left**2))
        return left


def _begun_warm(
    residual: np.ndarray, warm: np.ndarray, cold: np.ndarray, heat: np.ndarray
) -> np.ndarray:
    """A residual (n,) without the heat that its log begins with, where that is none of a scale.

    warm  what more of the effort such heat asks for;  cold  the effort without any;  heat  what the
    log's own adds; (n,) each
    """
    begun = residual + np.clip(-_part(residual, warm), 0.0, HOT) * warm
    scaled = residual - heat - _part(residual - heat, cold) * cold
    return begun if np.dot(begun, begun) < SURELY * np.dot(scaled, scaled) else residual


def _part(values: np.ndarray, column: np.ndarray) -> float:
    """How much of a column values (n,) hold, by least squares."""
    return float(np.dot(column, values) / max(np.dot(column, column), LEAST))


def _left(residual: np.ndarray, columns: np.ndarray, noise: float) -> np.ndarray:
    """What columns (s, n), of size 1, leave of a residual (n,) in noise of this mean square."""
    gram = columns @ columns.T + max(noise, LEAST) * np.eye(len(columns))
    return np.asarray(residual - np.linalg.solve(gram, columns @ residual) @ columns)
