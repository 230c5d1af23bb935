"""The drives' end of the bus: a command frame in, one millisecond of physics, feedback out.

Time is the machine's own and in lockstep with the commands: cycle k runs from k ms to k+1 ms, the
command carries the stamp of its start, the feedback that of its end, and nothing depends on when
the computer got round to it.  In a cycle without a command the last one holds, but not for ever:
drives stop by themselves when nobody speaks to them.  C620-style drives take currents; those of a
machine in voltage mode are GM6020-style and take voltages.
"""

import can
import numpy as np

from spirob.can_protocol import (
    COMMAND_ID,
    FEEDBACK_ID,
    Feedback,
    decode_command,
    encode_command,
    encode_feedback,
)
from spirob.drives.codec import VOLTAGE_FEEDBACK_ID, VOLTAGE_ID, decode_volts
from spirob.emulator.faults import Wire
from spirob.emulator.machine import Machine
from spirob.robot import CYCLE_NS, MOTORS

SECOND_NS = 1e9
HOLD_CYCLES = 100  # that a drive goes on with its last current
HOLD_VOLTAGE = 10  # and with its last voltage, which does not know what current it drives
IDLE = encode_command((0.0,) * len(MOTORS))


class DriveNode:
    """Two drives that share one command frame.

    now_ns  simulated time since the trial began
    command_id, feedback_id  what it listens to, and before what it says
    wire    what goes wrong inside the drives
    """

    def __init__(self, bus: can.BusABC, machine: Machine, wire: Wire | None = None):
        self.machine = machine
        self._bus = bus
        self._wire = wire or Wire()
        self._volts = float(machine.numbers["supply"][0])
        by_voltage = machine.rig.by_voltage
        self.command_id = VOLTAGE_ID if by_voltage else COMMAND_ID
        self.feedback_id = VOLTAGE_FEEDBACK_ID if by_voltage else FEEDBACK_ID
        self._wire.feedback_id = self.feedback_id
        self._decode = decode_volts if by_voltage else decode_command
        self._hold = HOLD_VOLTAGE if by_voltage else HOLD_CYCLES
        self.begin()

    def begin(self) -> None:
        """A new trial at time zero, without any command yet."""
        self.now_ns = self._idle = 0
        self._command = IDLE

    def cycle(self, silent: bool = False) -> None:
        """One millisecond under the latest command that is waiting, or else under the last.

        silent  nothing is told of it
        """
        self._idle += 1
        while (message := self._bus.recv(timeout=0)) is not None:
            if message.arbitration_id == self.command_id and not message.is_extended_id:
                self._command, self._idle = bytes(message.data), 0
        if self._idle > self._hold:
            self._command = IDLE
        if self._wire:
            self.machine.numbers["supply"] = self._wire.supply(self._volts)
        counts = self.machine.cycle(self._decode(self._command, len(MOTORS)))
        self.now_ns += CYCLE_NS
        if not silent:
            self._tell(counts)

    def _tell(self, counts: np.ndarray) -> None:
        for drive, (angle, speed, current, temperature) in enumerate(counts.tolist(), start=1):
            feedback = Feedback(angle, speed, current, temperature)
            if self._wire:
                feedback = self._wire.sensed(drive - 1, feedback)
            self._bus.send(
                can.Message(
                    timestamp=self.now_ns / SECOND_NS,
                    arbitration_id=self.feedback_id + drive,
                    is_extended_id=False,
                    data=encode_feedback(feedback),
                )
            )
