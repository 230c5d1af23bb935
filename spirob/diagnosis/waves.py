"""How a wave of torque at the rotor reaches the residual.

A torque is not seen as it is: the rotor's inertia takes it up, the controller answers it at the
pace of its loop, and through the arm the other motor's length moves.  So the model itself is
asked: it plays the trials with small waves of a few orders, and for each trial, motor and
compared signal the linear answer h that explains what came of them is fitted,

    r(t) = Σ_m ∫ h_m(s) w_m(t - s) ds,      w_m = sin or cos of Nθ_m, times the effort or not.

With it the residual of any order is known without playing it.  Fitted to five orders, the answer
to others is right to 1 to 6 % of its mean square up to one wave a turn, 12 % at two, 20 % at seven.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import signal

from spirob.effects import Effect
from spirob.identify.fit import Fit
from spirob.identify.problem import Problem, Rotor

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
        columns.append(signal.lfilter([1.0 - kept], [1.0, -kept], values))
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
