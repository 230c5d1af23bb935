"""How long after a reading the voltage by it acts, from a log of a loop on the host.

    i(k+1) = E i(k) + b₁ u(k-d-1) + b₀ u(k-d) - k_e ω (1 - E)/R,    τ = (d + δ)T

the winding under held voltages as in `control.host_loop`, driven by the voltages that were sent
and the speed that was read.  τ and the motors' R are those that leave the least of the measured
current; L and k_e are nominal.  A held current tells nothing of τ, and one that rises by 16 A/s, as
where a trial begins, less where τ is little more than a cycle: a voltage then acts as if at once.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import lfilter

from spirob.control.host_loop import Winding
from spirob.errors import DataError
from spirob.plant.rig import Motor

LATEST = 5e-3  # s
REACH = 0.2  # of the nominal resistance
GRID = 11  # latencies from which one is refined, for b₀ and b₁ have a kink at each whole cycle
LEAST = 0.05  # A, span of the current that can be told from noise and counts


@dataclass(frozen=True)
class Latency:
    """τ [s], its standard deviation [s], and the resistances found with it (motors,) [Ω]."""

    seconds: float
    error: float
    resistance: np.ndarray


def latency(current: np.ndarray, voltage: np.ndarray, speed: np.ndarray, motor: Motor) -> Latency:
    """Of a trial that begins at rest; both motors hear of their voltages in one frame.

    current, voltage, speed  (T, motors) as read [A], as sent [V], of the rotor [rad/s]
    Raises DataError where a current hardly moves.
    """
    if np.ptp(current, axis=0).min(initial=np.inf) < LEAST:
        raise DataError(f"a latency is told by currents that change, by {LEAST:g} A at least")
    motors = current.shape[1]

    def left(numbers: np.ndarray) -> np.ndarray:
        apart = [
            answer(
                Winding(float(share) * motor.resistance, motor.inductance),
                1e-3 * float(numbers[0]),
                voltage[:, m],
                motor.emf_constant * speed[:, m],
            )
            - current[:, m]
            for m, share in enumerate(numbers[1:])
        ]
        return np.concatenate(apart)

    most = 1e3 * LATEST
    grid = [np.array([t, *np.ones(motors)]) for t in np.linspace(0.0, most, GRID)[1:-1]]
    begin = min(grid, key=lambda one: float(np.sum(left(one) ** 2)))
    reach = REACH * np.ones(motors)
    bounds = np.array([0.0, *(1 - reach)]), np.array([most, *(1 + reach)])
    found = least_squares(left, begin, bounds=bounds, diff_step=1e-3)
    spread = 2 * found.cost / (len(found.fun) - len(begin))
    error = np.sqrt(spread * np.linalg.pinv(found.jac.T @ found.jac)[0, 0])
    resistance = found.x[1:] * motor.resistance
    return Latency(1e-3 * float(found.x[0]), 1e-3 * float(error), resistance)


def answer(winding: Winding, seconds: float, voltage: np.ndarray, emf: np.ndarray) -> np.ndarray:
    """Current (T,) [A] of a winding at rest under voltages that act so much later."""
    whole, first, second = winding.answer(seconds)
    sent = np.pad(voltage, (whole + 1, 0))  # nothing was before
    acts = first * sent[1 : len(voltage) + 1] + second * sent[: len(voltage)]
    acts -= (1.0 - winding.decay) / winding.resistance * emf
    return np.asarray(lfilter([0.0, 1.0], [1.0, -winding.decay], acts))
