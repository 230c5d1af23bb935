"""The paper's current loop on the host, step j_a: a voltage out of what the bus has brought.

    u_ff = L di_cmd/dt + R i_cmd + k_e ω                      (12)
    u_fb = K_p e + K_i ∫e dt + K_d de/dt,   e = i_cmd - i     (13)

Once a cycle, with readings as old as the bus makes them.  One scalar function, the same on a robot
(plain Python) and inside the compiled model.  R, L and k_e are what the host believes; of the
back-EMF it may feed forward a share (`drive.emf_compensation`), all of it in the paper.
"""

from spirob.parameter import Numbers, bounded

CYCLE = 1e-3  # s: the loop's period


class HostLoop(Numbers):
    """The loop's numbers; gains that are all zero are placed for `bandwidth` (`host_gains`)."""

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
