"""The current loop on the host of a robot whose drives take voltages, between guard and bus."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from spirob.control.host_loop import CYCLE, HostLoop, Placed, host_voltage, placed
from spirob.drives import Drive
from spirob.drives.codec import encode_volts
from spirob.errors import ConfigError
from spirob.robot import MOTORS
from spirob.safety.motor import MotorState

if TYPE_CHECKING:
    from spirob.plant import Rig


class HostCurrentLoop:
    """u = u_ff + u_fb of (12), (13), once a cycle, by what each motor last said.

    A motor that has said nothing new keeps its feedback part: the integral does not count one
    reading twice, and the guard stops the trial after 10 ms.

    loop, resistance [Ω], inductance [H], emf_constant [V·s/rad]   what the host believes, of the
                         back-EMF as much as it feeds forward
    limit                of a voltage [V]
    rotor_per_velocity   rotor speed over tendon speed [rad/m], G/r
    Raises ConfigError where the gains are unstable.
    """

    def __init__(
        self,
        loop: HostLoop,
        resistance: float,
        inductance: float,
        emf_constant: float,
        limit: float,
        rotor_per_velocity: float,
    ):
        self.placed: Placed = placed(loop, resistance, inductance)
        self._motor = (resistance, inductance, emf_constant)
        self._limit, self._turn = limit, rotor_per_velocity
        self.begin()

    @classmethod
    def of(cls, rig: "Rig", limit: float) -> "HostCurrentLoop | None":
        """The loop of a rig that closes it on the host, None of any other; limit [V]."""
        if rig.host is None:
            return None
        motor, winch = rig.motor, rig.winch
        most = min(limit, rig.drive.voltage_limit)
        emf = rig.drive.emf_compensation * motor.emf_constant
        turn = winch.gear_ratio / winch.radius
        return cls(rig.host, motor.resistance, motor.inductance, emf, most, turn)

    def begin(self) -> None:
        """Forget the trial before."""
        self._integral = [0.0] * len(MOTORS)
        self._command: list[float | None] = [None] * len(MOTORS)
        self._error = [0.0] * len(MOTORS)
        self._heard = [-1] * len(MOTORS)

    def __call__(self, currents: Sequence[float], states: Sequence[MotorState]) -> bytes:
        """The payload of voltages for the currents [A] that are asked for."""
        volts = [self._volts(m, currents[m], state) for m, state in enumerate(states)]
        return encode_volts(tuple(volts))

    def _volts(self, m: int, command: float, state: MotorState) -> float:
        fresh = state.heard_ns != self._heard[m]
        before = self._command[m]
        if before is None:
            before, self._error[m] = 0.0, command - state.current
        voltage, integral, error = host_voltage(
            command,
            before,
            state.current,
            self._error[m],
            state.velocity * self._turn,
            self._integral[m],
            CYCLE,
            *self._motor,
            *self.placed.gains,
            self._limit,
        )
        self._command[m] = command
        if fresh:
            self._integral[m], self._error[m], self._heard[m] = integral, error, state.heard_ns
        return voltage


def require_fitting(drive: Drive | None, loop: object | None) -> None:
    """Raises ConfigError where a drive takes voltages and nothing makes them, or the other way."""
    if loop and not (drive and drive.by_voltage):
        name = drive.about.name if drive else "c620"
        raise ConfigError(
            f"drive '{name}' has no voltage mode, which drive.loop: host needs; gm6020 has one"
        )
    if drive and drive.by_voltage and not loop:
        raise ConfigError(
            f"drive '{drive.about.name}' takes voltages: it needs rig.drive.loop: host"
        )
