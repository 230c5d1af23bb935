"""Two drives on a virtual bus: each answers at its own millisecond, in a thread of its own."""

import threading
import time

import can

from spirob.can_protocol import COMMAND_ID, FEEDBACK_ID, Feedback, decode_command, encode_feedback
from spirob.robot import MOTORS


class FakeDrives:
    """Answers every command; `mute` names the motors that do not. Keeps all commands."""

    def __init__(self, channel, mute=()):
        self.bus = can.Bus(interface="virtual", channel=channel)
        self.mute = set(mute)
        self.commands = []
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._serve, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *error):
        self._stop.set()
        self._thread.join()
        self.bus.shutdown()

    def wait_for(self, condition, seconds=2.0):
        """True as soon as `condition` of the commands holds."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if condition(self.commands):
                return True
            time.sleep(0.001)
        return False

    def _serve(self):
        angle = 0
        while not self._stop.is_set():
            message = self.bus.recv(0.02)
            if message is None or message.arbitration_id != COMMAND_ID:
                continue
            currents = decode_command(bytes(message.data))
            self.commands.append(currents)
            angle = (angle + 5) % 8192
            for m, motor in enumerate(MOTORS):
                if motor not in self.mute:
                    data = encode_feedback(Feedback(angle, 10, round(currents[m] * 100), 30))
                    self.bus.send(
                        can.Message(
                            arbitration_id=FEEDBACK_ID + 1 + m, data=data, is_extended_id=False
                        )
                    )
