"""The drives' end of the bus: a command frame in, one millisecond of physics, feedback out.

Time is the machine's own and in lockstep with the commands: cycle k runs from k ms to k+1 ms, the
command carries the stamp of its start, the feedback that of its end, and nothing depends on when
the computer got round to it.
"""

import can

from spirob.can_protocol import COMMAND_ID, FEEDBACK_ID, Feedback, decode_command, encode_feedback
from spirob.emulator.machine import Machine
from spirob.robot import CYCLE_NS, MOTORS

SECOND_NS = 1e9


class DriveNode:
    """Two drives that share one command frame.

    now_ns  simulated time since the trial began
    """

    def __init__(self, bus: can.BusABC, machine: Machine):
        self.machine = machine
        self.now_ns = 0
        self._bus = bus

    def serve(self) -> int:
        """Answer every command frame that is waiting; returns how many there were."""
        answered = 0
        while (message := self._bus.recv(timeout=0)) is not None:
            if message.arbitration_id == COMMAND_ID and not message.is_extended_id:
                self._answer(bytes(message.data))
                answered += 1
        return answered

    def _answer(self, payload: bytes) -> None:
        counts = self.machine.cycle(decode_command(payload, len(MOTORS)))
        self.now_ns += CYCLE_NS
        for drive, (angle, speed, current, temperature) in enumerate(counts.tolist(), start=1):
            feedback = Feedback(angle, speed, current, temperature)
            self._bus.send(
                can.Message(
                    timestamp=self.now_ns / SECOND_NS,
                    arbitration_id=FEEDBACK_ID + drive,
                    is_extended_id=False,
                    data=encode_feedback(feedback),
                )
            )
