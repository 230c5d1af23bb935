"""The orders of a ripple, and how a wave of torque at the rotor reaches the residual.

A ripple's kernel is linear in its amplitudes but not in its orders, so these are looked for where
the other numbers begin: at each order of a grid the residual is regressed on what the model answers
to a sine and a cosine of the rotor's angle, separately for each motor, beside the columns
of the fitted numbers.  Of several orders each is found beside the waves of the others.

How periodic a residual is over an angle at each order, its spectrum says,

    P(N) = 2 |Σ r exp(-i N θ)|² / (n Σ r²),      θ the angle, r the residual about its mean

the share of its square that a wave of order N explains where the angle is travelled evenly.

A torque is not seen as it is: the rotor's inertia takes it up, the controller answers it at the
pace of its loop, and through the arm the other motor's length moves.  So the model itself is
asked: it plays the trials with small waves of a few orders, and for each trial, motor and
compared signal the linear answer h that explains what came of them is fitted,

    r(t) = Σ_m ∫ h_m(s) w_m(t - s) ds,      w_m = sin or cos of Nθ_m, times the effort or not.

With it the residual of any order is known without playing it.  Fitted to five orders, the answer
to others is right to 1 to 6 % of its mean square up to one wave a turn, 12 % at two, 20 % at seven.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from spirob.effects import Effect
from spirob.identify.fit import Fit
from spirob.identify.problem import Problem, Rotor

PEAKS = 4
MOST_BINS = 2**20  # of the angle; beyond, the highest orders are not looked at


def peaks(
    residual: np.ndarray, angle: np.ndarray, low: float, high: float, count: int = PEAKS
) -> list[float]:
    """The orders in which the residual is most periodic over the angle, strongest first."""
    orders, power = spectrum(residual, angle, low, high)
    if len(orders) < 3:
        return [float(np.sqrt(low * high))]
    found: list[float] = []
    apart = 2 * np.pi / max(np.ptp(angle), 1e-9)
    for k in np.argsort(-power):
        if all(abs(orders[k] - other) > apart for other in found):
            found.append(float(orders[k]))
        if len(found) == count:
            break
    return found


def spectrum(
    residual: np.ndarray, angle: np.ndarray, low: float, high: float
) -> tuple[np.ndarray, np.ndarray]:
    """Share of the squared residual that a wave of each order explains, (M,) and (M,).

    Orders from one period over the travelled angle, a quarter of a period apart.  The residual is
    summed into bins of the angle, an eighth of the shortest period wide, and transformed at once:
    a sample in the middle of its bin then loses at most 3 % of the shortest wave.
    """
    travel = max(float(np.ptp(angle)), 1e-9)
    width = 2 * np.pi / (8.0 * high)
    count = int(travel / width) + 1
    if count > MOST_BINS:
        width, count = travel / (MOST_BINS - 1), MOST_BINS
    cells = np.minimum(((angle - angle.min()) / width).astype(int), count - 1)
    sums = np.bincount(cells, weights=residual - residual.mean(), minlength=count)
    padded = 4 * count
    power = np.abs(np.fft.rfft(sums, padded)) ** 2
    orders = 2 * np.pi * np.arange(len(power)) / (padded * width)
    inside = (orders >= max(low, 2 * np.pi / travel)) & (orders <= high)
    total = float(np.sum((residual - residual.mean()) ** 2)) * len(residual) / 2.0
    return orders[inside], power[inside] / max(total, 1e-300)


PROBES = (0.1, 0.3, 1.0, 3.0, 10.0)  # waves a turn that are played
SIZE = 0.5  # of the amplitude's nominal value
DELAYS = range(0, 96, 4)  # samples: the answer's first tenth of a second
DECAYS = (100.0, 300.0, 1000.0)  # samples: its tail
RIDGE = 1e-3  # of the largest column: what the probes leave open is zero
BY_LOAD = {"motor.torque": False, "motor.drive_torque": True}  # port -> grows with the effort?


@dataclass(frozen=True)
class Waves:
    """The answer of one trial to waves at its rotors.

    answers  [signal][motor] impulse response (n,) at the rate of the unfiltered signals
    """

    problem: Problem
    rotors: Sequence[Rotor]
    by_load: bool
    answers: Sequence[Sequence[np.ndarray]]

    def columns(self, orders: np.ndarray) -> np.ndarray:
        """Residual of unit sine and cosine at each motor, (orders, rows of the trial, 2·motors)."""
        found = []
        for motor, rotor in enumerate(self.rotors):
            for phase in (0.0, np.pi / 2):
                waves = wave(self.problem, rotor, orders[:, None], phase, self.by_load)
                spectra = np.fft.rfft(waves, self._length)[:, : self._kept]
                parts = [self._thinned(spectra * s[motor]) for s in self._spectra]
                found.append(np.concatenate(parts, axis=1))
        return np.stack(found, axis=2)

    @cached_property
    def _length(self) -> int:
        rotor = self.rotors[0]  # twice as long, so that the end does not answer at the beginning
        return rotor.every * -(-2 * len(rotor.angle) // rotor.every)

    @cached_property
    def _kept(self) -> int:
        # the filter leaves nothing above half the rate at which samples are kept
        return self._length // self.rotors[0].every // 2 + 1

    @cached_property
    def _spectra(self) -> list[list[np.ndarray]]:
        spectra = [np.fft.rfft(by_motor, self._length) for by_motor in self.answers]
        return [list(s[:, : self._kept]) for s in spectra]

    def _thinned(self, spectra: np.ndarray) -> np.ndarray:
        rotor = self.rotors[0]
        whole = np.fft.irfft(spectra, self._length // rotor.every) / rotor.every
        return whole.take(rotor.compared // rotor.every, axis=1)


def wave(
    problem: Problem, rotor: Rotor, order: float | np.ndarray, phase: float, by_load: bool
) -> np.ndarray:
    """A wave over the rotor's angle, as the residual's filter leaves it, (..., n)."""
    plain = np.sin(order * rotor.angle + phase)
    return problem.filter(plain * rotor.effort if by_load else plain)


def answers(problem: Problem, base: Fit, effect: type[Effect]) -> list[Waves]:
    """What each trial answers to waves of this effect, beside the fitted model `base`.

    effect  a ripple: a wave of its `order` with the amplitudes `sine` and `cosine`
    """
    size = SIZE * effect.parameters()["sine"].nominal
    probes = [(order, phase) for order in PROBES for phase in (0.0, np.pi / 2)]
    points = []
    for order, phase in probes:
        own = {"order": order, "sine": size * np.cos(phase), "cosine": size * np.sin(phase)}
        points.append(base.changes | {f"{effect.name()}.{f}": v for f, v in own.items()})
    seen = [(r - base.residual) / size for r in problem.many(points)]
    by_load = BY_LOAD[effect.port]
    found = []
    for k, rotors in enumerate(problem.rotors()):
        rows = slice(problem.edges[k], problem.edges[k + 1])
        if rows.start == rows.stop:
            continue  # nothing is compared where both currents are commanded
        played = [[_basis(wave(problem, r, *p, by_load)) for r in rotors] for p in probes]
        fitted = _fitted(played, [s[rows] for s in seen], rotors[0].compared)
        found.append(Waves(problem, rotors, by_load, fitted))
    return found


def following(trials: Sequence[Waves], effect: type[Effect]) -> list[Waves]:
    """The same answers to waves of another ripple: all act as a torque at the rotor."""
    return [replace(trial, by_load=BY_LOAD[effect.port]) for trial in trials]


def _basis(values: np.ndarray) -> np.ndarray:
    """A signal late by each delay, and smoothed by each decay, (n, delays + decays)."""
    columns = [np.concatenate([np.zeros(k), values[: len(values) - k]]) for k in DELAYS]
    for tau in DECAYS:
        kept = np.exp(-1.0 / tau)
        columns.append(scipy.signal.lfilter([1.0 - kept], [1.0, -kept], values))
    return np.column_stack(columns)


def _fitted(
    played: Sequence[Sequence[np.ndarray]], seen: Sequence[np.ndarray], places: np.ndarray
) -> list[list[np.ndarray]]:
    """Impulse responses [signal][motor] by least squares; `places` of the samples in `seen`."""
    design = np.concatenate([np.column_stack(motors)[places] for motors in played])
    signals = [s.reshape(-1, len(places)) for s in seen]
    goals = np.concatenate(signals, axis=1).T
    ridge = RIDGE * np.linalg.norm(design, axis=0).max()
    square = design.T @ design + ridge**2 * np.eye(design.shape[1])
    weights = np.linalg.solve(square, design.T @ goals)
    first = np.zeros(len(played[0][0]))
    first[0] = 1.0
    impulse = _basis(first)
    motors = len(played[0])
    return [[impulse @ w for w in np.split(column, motors)] for column in weights.T]


LOWEST, HIGHEST = 0.03, 50.0  # waves a turn
STEP = 0.03  # to the next order of the grid, relative
PHASE = 0.5  # waves over the whole way by which neighbours differ at most
MOST = 600  # orders in the grid
FINER = 8  # steps to a neighbour, round the best
SAME = 1e-10  # of the largest: waves that differ by less of their square are one
WAVES = 0.4  # of the order's least: so many over the whole way, or it is a slope


def best_orders(
    base: Fit, trials: Sequence[Waves], count: int = 1, least: float = LOWEST
) -> list[float]:
    """The orders that explain most of the residual, lowest first.

    base    the fit without the ripple;  trials  what each answers to waves of it
    least   order that the ripple may have
    """
    way = max(float(np.ptp(r.angle)) for t in trials for r in t.rotors) / (2 * np.pi)
    grid = _grid(way, least)
    waves = _columns(trials, grid)
    found: dict[int, float] = {}
    for place in list(range(count)) * (1 if count == 1 else 2):
        others = [n for k, n in found.items() if k != place]
        known = base.jacobian
        if others:
            known = np.column_stack([known, *_columns(trials, others)])
        free = [k for k, n in enumerate(grid) if _apart(n, others, way)]
        if free:
            best = grid[free[_strongest(base.residual, known, waves[free])]]
            near = best + _step(best, way) * np.arange(1 - FINER, FINER) / FINER
            near = near[near >= grid[0]]
            found[place] = near[_strongest(base.residual, known, _columns(trials, near))]
    return sorted(float(n) for n in found.values())


def _grid(way: float, least: float) -> np.ndarray:
    """Orders to try where the rotor makes `way` turns: no wave falls between two of them."""
    orders = [max(LOWEST, least, WAVES / way)]
    while orders[-1] < HIGHEST and len(orders) < MOST:
        orders.append(orders[-1] + _step(orders[-1], way))
    return np.array(orders)


def _step(order: float, way: float) -> float:
    return min(STEP * order, PHASE / way)


def _apart(order: float, others: Sequence[float], way: float) -> bool:
    """Whether the stroke tells this order from the others: a neighbour is the same wave."""
    return all(abs(order - other) * way > 2 * WAVES for other in others)


def _columns(trials: Sequence[Waves], orders: Sequence[float] | np.ndarray) -> np.ndarray:
    """The waves of some orders in the whole residual, (orders, N, 2·motors)."""
    with ThreadPoolExecutor(trials[0].problem.workers) as pool:
        return np.concatenate(
            list(pool.map(lambda t: t.columns(np.asarray(orders)), trials)), axis=1
        )


def _strongest(residual: np.ndarray, known: np.ndarray, waves: np.ndarray) -> int:
    """Which order's waves explain most of the residual beside the known columns."""
    basis, _ = np.linalg.qr(known)
    left = residual - basis @ (basis.T @ residual)
    own = waves - basis @ (basis.T @ waves)
    across = own.transpose(0, 2, 1)
    told = across @ left
    square = np.linalg.pinv(across @ own, rcond=SAME, hermitian=True)
    return int(np.argmax(np.einsum("ki,kij,kj->k", told, square, told)))
