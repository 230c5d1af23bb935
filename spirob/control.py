"""What a trial asks of each motor in each cycle: feedback points, and the current loop on the host.

Each law is one scalar function, the same on a real robot (plain Python, once a cycle) and inside
the compiled model.

The feedback points make a current of a reference.  Measured quantities are what the drive reports,
already in SI units: wound-in length x, its rate v, current i.

    current        i_cmd = i_ref
    velocity       i_cmd = K_v (v_ref - v) + I,        İ = K_i (v_ref - v)
    displacement   velocity law with v_ref = ẋ_ref + K_x (x_ref - x)
    force          i_cmd = (F_ref + K_F (F_ref - F)) / n,   F = n·i - c·v

(paper, "Alternative feedback points", e_Δℓ, e_Δℓ̇, e_F and Φ.)  The integral stops while the
command is at its limit and the error would drive it further (anti-windup).

The current loop on the host, step j_a, makes a voltage out of that current:

    u_ff = L di_cmd/dt + R i_cmd + k_e ω                      (12)
    u_fb = K_p e + K_i ∫e dt + K_d de/dt,   e = i_cmd - i     (13)

Readings are as old as the bus makes them.  R, L and k_e are what the host believes; of the back-EMF
it may feed forward a share (`drive.emf_compensation`), all of it in the paper.

Its gains are placed by the poles of (14) with hold and latency in the loop.  A voltage is held for
a cycle T, and acts τ = (d + δ)T after the reading that it follows from:

    i(k+1) = E i(k) + b₁ u(k-d-1) + b₀ u(k-d)         E = exp(-TR/L)
    b₀ = (1 - E^(1-δ))/R,   b₁ = (E^(1-δ) - E)/R
    C(z) = K_p + K_i T/(z - 1) + K_d (z - 1)/(Tz)
    (z - E) z^(d+1) + (b₀ z + b₁) C(z) = 0

the poles.  (14) has two; placed for a bandwidth f with K_d = 0 they are the winding's own, E, and
z₁ = exp(-2πfT):

    K_p = z₁^(d+1) (1 - z₁)/(b₀ z₁ + b₁),   K_i = K_p (1 - E)/T

Without latency and T → 0 that is K_p = 2πf L, K_i = 2πf R.  The gain grows with f up to where z₁
meets the next of the poles that the latency brings; a bandwidth beyond that cannot be had.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from spirob.errors import ConfigError
from spirob.parameter import Numbers, bounded

CURRENT, VELOCITY, DISPLACEMENT, FORCE = 0, 1, 2, 3
MODES = {"current": CURRENT, "velocity": VELOCITY, "displacement": DISPLACEMENT, "force": FORCE}


class Gains(Numbers):
    """Gains of the mechanical feedback; defaults suit the geared rig (18 kg seen at the tendon)."""

    owner = "gains"

    velocity: float = bounded(35.0, 0.0, 1e4, "A·s/m", "K_v", "proportional, on velocity")
    integral: float = bounded(260.0, 0.0, 1e6, "A/m", "K_i", "integral, on velocity")
    displacement: float = bounded(8.0, 0.0, 1e3, "1/s", "K_x", "displacement error to velocity")
    force: float = bounded(0.5, 0.0, 100.0, "1", "K_F", "proportional, on tendon force")
    newton_per_ampere: float = bounded(15.0, 0.01, 1e3, "N/A", "n", "nominal ηGk_t/r")
    drag: float = bounded(92.0, 0.0, 1e5, "N·s/m", "c", "nominal b_eq/r²")


def current_command(
    mode,
    reference,
    reference_rate,
    displacement,
    velocity,
    current,
    integral,
    dt,
    current_limit,
    gain_velocity,
    gain_integral,
    gain_displacement,
    gain_force,
    newton_per_ampere,
    drag,
):
    """Commanded current [A] and the next value of the integral [A].

    mode            CURRENT, VELOCITY, DISPLACEMENT or FORCE
    reference       [A], [m/s], [m] or [N], by mode;  reference_rate  [m/s], displacement only
    displacement, velocity, current   as measured: [m], [m/s], [A]
    current_limit   the command stays within ± this [A]
    """
    if mode == 0:
        return min(max(reference, -current_limit), current_limit), 0.0
    if mode == 3:
        force = newton_per_ampere * current - drag * velocity
        command = (reference + gain_force * (reference - force)) / newton_per_ampere
        return min(max(command, -current_limit), current_limit), 0.0
    error = reference - velocity
    if mode == 2:
        error = reference_rate + gain_displacement * (reference - displacement) - velocity
    command = gain_velocity * error + integral
    limited = min(max(command, -current_limit), current_limit)
    if command == limited or command * error < 0.0:
        integral += gain_integral * error * dt
    return limited, integral


@dataclass(frozen=True)
class Schedule:
    """Feedback mode and reference of every motor at every cycle.

    mode           (M,) int, constants of `control`; fixed during a trial
    reference      (T, M) in the unit of the mode: A, m/s, m or N
    reference_rate (T, M) [m/s], read by the displacement mode only
    current_limit  (M,) the command stays within ± this [A]
    held           (M,) currents under which the arm has come to rest before [A]; None: none
    """

    mode: np.ndarray
    reference: np.ndarray
    reference_rate: np.ndarray
    current_limit: np.ndarray
    held: np.ndarray | None = None

    @property
    def cycles(self) -> int:
        """Length of the trial in cycles."""
        return len(self.reference)


CYCLE = 1e-3  # s: the loop's period


class HostLoop(Numbers):
    """The loop's numbers; gains that are all zero are placed for `bandwidth` (`placed`)."""

    owner = "host"

    bandwidth: float = bounded(50.0, 0.1, 500.0, "Hz", "f_h", "pole at which gains are placed")
    latency: float = bounded(
        1e-3, 0.0, 1.999e-3, "s", "τ", "from a reading until the voltage by it acts: a cycle"
    )
    proportional: float = bounded(0.0, 0.0, 1e3, "V/A", "K_p", "gain of (13)")
    integral: float = bounded(0.0, 0.0, 1e6, "V/(A·s)", "K_i", "gain of (13)")
    derivative: float = bounded(0.0, 0.0, 1.0, "V·s/A", "K_d", "gain of (13)")

    @property
    def gains(self) -> tuple[float, float, float] | None:
        """K_p, K_i and K_d where they are given."""
        given = self.proportional, self.integral, self.derivative
        return given if any(given) else None


def host_voltage(
    command,
    command_before,
    current,
    error_before,
    rotor_speed,
    integral,
    dt,
    resistance,
    inductance,
    emf_constant,
    gain_p,
    gain_i,
    gain_d,
    limit,
):
    """Voltage u = u_ff + u_fb [V] of (12) and (13), the next integral [V], and e [A].

    command, command_before  i_cmd of this cycle and of the one before [A]
    current, rotor_speed     as read: [A], [rad/s];  error_before  e of the cycle before [A]
    limit                    of the voltage [V]; the integral stops while it holds and the error
                             would drive it further
    """
    error = command - current
    forward = inductance * (command - command_before) / dt + resistance * command
    wanted = forward + emf_constant * rotor_speed + integral
    wanted += gain_p * error + gain_d * (error - error_before) / dt
    voltage = min(max(wanted, -limit), limit)
    if voltage == wanted or wanted * error < 0.0:
        integral += gain_i * error * dt
    return voltage, integral, error


LATEST = 10e-3  # s; how far a margin of latency is looked for
TIMES = 1e4  # by which gains are multiplied at most when a margin is looked for
HALVINGS = 60
GRID = 400
Placement = tuple[float, float, float]


@dataclass(frozen=True)
class Winding:
    """R [Ω] and L [H] as the host believes them."""

    resistance: float
    inductance: float

    @property
    def decay(self) -> float:
        """E, what is left of a current after a cycle."""
        return float(np.exp(-CYCLE * self.resistance / self.inductance))

    def answer(self, latency: float) -> tuple[int, float, float]:
        """d, b₀ and b₁ [A/V] at a latency [s]."""
        whole = int(latency / CYCLE + 1e-9)
        part = max(0.0, latency / CYCLE - whole)
        rest = self.decay ** (1.0 - part)
        return whole, (1.0 - rest) / self.resistance, (rest - self.decay) / self.resistance


@dataclass(frozen=True)
class Placed:
    """Gains, and how far they are from the edge.

    gains    K_p [V/A], K_i [V/(A·s)], K_d [V·s/A];  poles  of the loop in z
    times    factor by which all gains may grow until a pole leaves the unit circle
    latest   latency [s] at which these gains become unstable, at most `LATEST`
    """

    gains: Placement
    poles: np.ndarray
    times: float
    latest: float

    def told(self) -> str:
        """In a sentence, for a log and a report."""
        p, i, d = self.gains
        more = " or more" if self.latest >= LATEST else ""
        return (
            f"K_p {p:.4g} V/A, K_i {i:.4g} V/(A·s), K_d {d:.4g} V·s/A; slowest pole "
            f"{abs(self.poles).max():.3f}; stable up to {self.times:.2f} times the gains, "
            f"or a latency of {1e3 * self.latest:.2f} ms{more}"
        )


def polynomial(winding: Winding, latency: float, gains: Placement) -> np.ndarray:
    """Coefficients of the loop's characteristic polynomial, highest power first."""
    proportional, integral, derivative = gains
    whole, first, second = winding.answer(latency)
    over, under = np.array([proportional]), np.array([1.0])
    if integral:
        over = np.polyadd(np.polymul(over, [1.0, -1.0]), [integral * CYCLE])
        under = np.array([1.0, -1.0])
    if derivative:
        step = derivative / CYCLE * np.polymul(under, [1.0, -1.0])
        over = np.polyadd(np.polymul(over, [1.0, 0.0]), step)
        under = np.polymul(under, [1.0, 0.0])
    alone = np.polymul([1.0, -winding.decay], np.eye(whole + 2)[0])  # (z - E) z^(d+1)
    return np.polyadd(np.polymul(alone, under), np.polymul([first, second], over))


def poles(winding: Winding, latency: float, gains: Placement) -> np.ndarray:
    """Poles of the loop in z; it is stable where all are within the unit circle."""
    return np.roots(polynomial(winding, latency, gains))


def stable(winding: Winding, latency: float, gains: Placement) -> bool:
    """Whether every error dies out."""
    return bool(np.abs(poles(winding, latency, gains)).max() < 1.0)


def fastest(winding: Winding, latency: float) -> float:
    """The largest bandwidth [Hz] for which gains can be placed."""
    whole, first, second = winding.answer(latency)
    z = np.linspace(1e-6, 1.0, 20001)[:-1]
    gain = z ** (whole + 1) * (1.0 - z) / (first * z + second)
    return float(-np.log(z[np.argmax(gain)]) / (2 * np.pi * CYCLE))


def for_bandwidth(winding: Winding, latency: float, bandwidth: float) -> Placement:
    """K_p, K_i and K_d = 0 with poles at the winding's own and at a bandwidth [Hz].

    Raises ConfigError with the largest bandwidth where that one cannot be had.
    """
    most = fastest(winding, latency)
    if bandwidth > most:
        raise ConfigError(
            f"a current loop on the host of {bandwidth:g} Hz cannot be had with a latency of "
            f"{1e3 * latency:g} ms; the largest bandwidth is {most:.1f} Hz"
        )
    whole, first, second = winding.answer(latency)
    z = np.exp(-2 * np.pi * bandwidth * CYCLE)
    proportional = float(z ** (whole + 1) * (1.0 - z) / (first * z + second))
    return proportional, proportional * (1.0 - winding.decay) / CYCLE, 0.0


def largest(winding: Winding, latency: float, gains: Placement) -> float:
    """The factor on all gains up to which the loop is stable, at most `TIMES`."""

    def holds(factor: float) -> bool:
        p, i, d = (factor * gain for gain in gains)
        return stable(winding, latency, (p, i, d))

    factors = np.geomspace(1 / TIMES, TIMES, GRID)
    return _edge(holds, factors)


def latest(winding: Winding, gains: Placement) -> float:
    """The latency [s] up to which these gains are stable, at most `LATEST`."""
    return _edge(lambda tau: stable(winding, tau, gains), np.linspace(0.0, LATEST, GRID))


def _edge(holds: Callable[[float], bool], values: np.ndarray) -> float:
    """The largest value before the first of a grid that does not hold, by halving."""
    broken = next((k for k, value in enumerate(values) if not holds(value)), None)
    if broken is None:
        return float(values[-1])
    if broken == 0:
        return 0.0
    low, high = values[broken - 1], values[broken]
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if holds(middle) else (low, middle)
    return float(low)


@lru_cache(maxsize=64)
def placed(loop: HostLoop, resistance: float, inductance: float) -> Placed:
    """The loop's gains, given or placed for its bandwidth.

    Raises ConfigError where they are unstable, with the largest of their proportions that are not.
    """
    winding = Winding(resistance, inductance)
    gains = loop.gains or for_bandwidth(winding, loop.latency, loop.bandwidth)
    times = largest(winding, loop.latency, gains)
    found = poles(winding, loop.latency, gains)
    if not np.abs(found).max() < 1.0:
        p, i, d = gains
        raise ConfigError(
            f"the current loop on the host is unstable with K_p = {p:.4g} V/A, "
            f"K_i = {i:.4g} V/(A·s), K_d = {d:.4g} V·s/A and a latency of "
            f"{1e3 * loop.latency:g} ms; the largest gains of these proportions that are stable: "
            f"K_p = {times * p:.4g}, K_i = {times * i:.4g}, K_d = {times * d:.4g}"
        )
    return Placed(gains, found, times, latest(winding, gains))
