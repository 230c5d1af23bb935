"""What a log of a current loop on the host tells of it: latency, resistances, back-EMF.

    i(k+1) = E i(k) + b₁ u(k-d-1) + b₀ u(k-d) - k_e ω (1 - E)/R,    τ = (d + δ)T

the windings under held voltages as in `control.host_loop`, driven by the voltages that were sent
and the speed that was read, of a cycle the mean of its ends.  τ, each motor's R and each motor's
k_e are those that leave the least of the measured current; L is nominal.  Currents that jump tell
τ, rotors that turn tell k_e; currents that are held tell neither.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from spirob.control.host_loop import Winding
from spirob.errors import DataError
from spirob.plant.rig import Motor

LATEST = 5e-3  # s
REACH = 0.2  # of the nominal resistance and back-EMF
GRID = 11  # latencies from which one is refined, for b₀ and b₁ have a kink at each whole cycle
LEAST = 0.05  # A, span of the current that can be told from noise and counts
TURNING = 1.0  # rad/s, RMS of a rotor whose back-EMF can: 20 mV


@dataclass(frozen=True)
class Windings:
    """τ [s] and its standard deviation [s]; R [Ω] and k_e [V·s/rad] of each motor, (motors,)."""

    latency: float
    error: float
    resistance: np.ndarray
    emf_constant: np.ndarray


def windings(current: np.ndarray, voltage: np.ndarray, speed: np.ndarray, motor: Motor) -> Windings:
    """Of a trial that begins at rest; both motors hear of their voltages in one frame.

    current, voltage, speed  (T, motors) as read [A], as sent [V], of the rotor [rad/s]
    Raises DataError where a current hardly moves or a rotor hardly turns.
    """
    if np.ptp(current, axis=0).min(initial=np.inf) < LEAST:
        raise DataError(f"a latency is told by currents that change, by {LEAST:g} A at least")
    if np.sqrt(np.mean(speed**2, axis=0)).min(initial=np.inf) < TURNING:
        raise DataError(f"a back-EMF is told by rotors that turn, by {TURNING:g} rad/s at least")
    motors = current.shape[1]
    middle = (speed + np.vstack([speed[1:], speed[-1:]])) / 2

    def left(numbers: np.ndarray) -> np.ndarray:
        shares = numbers[1:].reshape(2, motors)
        apart = [
            answer(
                Winding(float(shares[0, m]) * motor.resistance, motor.inductance),
                1e-3 * float(numbers[0]),
                voltage[:, m],
                float(shares[1, m]) * motor.emf_constant * middle[:, m],
            )
            - current[:, m]
            for m in range(motors)
        ]
        return np.concatenate(apart)

    most = 1e3 * LATEST
    grid = [np.array([t, *np.ones(2 * motors)]) for t in np.linspace(0.0, most, GRID)[1:-1]]
    begin = min(grid, key=lambda one: float(np.sum(left(one) ** 2)))
    reach = REACH * np.ones(2 * motors)
    bounds = np.array([0.0, *(1 - reach)]), np.array([most, *(1 + reach)])
    found = scipy.optimize.least_squares(left, begin, bounds=bounds, diff_step=1e-3)
    spread = 2 * found.cost / (len(found.fun) - len(begin))
    error = np.sqrt(spread * np.linalg.pinv(found.jac.T @ found.jac)[0, 0])
    resistance, emf = found.x[1:].reshape(2, motors)
    return Windings(
        1e-3 * float(found.x[0]),
        1e-3 * float(error),
        resistance * motor.resistance,
        emf * motor.emf_constant,
    )


def answer(winding: Winding, seconds: float, voltage: np.ndarray, emf: np.ndarray) -> np.ndarray:
    """Current (T,) [A] of a winding at rest under voltages that act so much later."""
    whole, first, second = winding.answer(seconds)
    sent = np.pad(voltage, (whole + 1, 0))  # nothing was before
    acts = first * sent[1 : len(voltage) + 1] + second * sent[: len(voltage)]
    acts -= (1.0 - winding.decay) / winding.resistance * emf
    return np.asarray(scipy.signal.lfilter([0.0, 1.0], [1.0, -winding.decay], acts))
