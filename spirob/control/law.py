"""The paper's feedback points, and what a trial asks of each motor, cycle by cycle.

One scalar function, the same on a real robot (plain Python, once a cycle) and inside the compiled
model.  Measured quantities are what the drive reports, already in SI units: wound-in length x,
its rate v, current i.

    current        i_cmd = i_ref
    velocity       i_cmd = K_v (v_ref - v) + I,        İ = K_i (v_ref - v)
    displacement   velocity law with v_ref = ẋ_ref + K_x (x_ref - x)
    force          i_cmd = (F_ref + K_F (F_ref - F)) / n,   F = n·i - c·v

(paper, "Alternative feedback points", e_Δℓ, e_Δℓ̇, e_F and Φ.)  The integral stops while the
command is at its limit and the error would drive it further (anti-windup).
"""

from dataclasses import dataclass

import numpy as np

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

    mode           (M,) int, constants of `control.law`; fixed during a trial
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
