"""Two ODrive axes on a virtual bus: torque in, estimates and currents out, floats throughout."""

import struct
import threading
import time
from math import pi

import can

TORQUE_CONSTANT = 0.0203
SPEED_PER_AMPERE = 4.0  # rotor rad/s, with a lag; slow, so that a stall hides no whole turn
LAG = 0.05


class FakeODrives:
    """Moves only in closed loop (axis state 8); answers when both torques of a cycle are there."""

    def __init__(self, channel):
        self.bus = can.Bus(interface="virtual", channel=channel)
        self.state, self.torque = [1, 1], [0.0, 0.0]
        self.speed, self.turns = [0.0, 0.0], [5.2, -3.7]
        self.torques, self.heard = [], []
        self._last = None
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
        """True as soon as a condition holds."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if condition():
                return True
            time.sleep(0.001)
        return False

    def _serve(self):
        while not self._stop.is_set():
            message = self.bus.recv(0.02)
            if message is None:
                continue
            axis, command, data = (
                message.arbitration_id >> 5,
                message.arbitration_id & 31,
                message.data,
            )
            self.heard.append((axis, command))
            if command == 7:
                self.state[axis] = struct.unpack_from("<I", data)[0]
            elif command == 14:
                self.torque[axis] = struct.unpack_from("<f", data)[0]
                if axis == 1:
                    self._cycle()

    def _cycle(self):
        self.torques.append(tuple(self.torque))
        now = time.monotonic()
        passed, self._last = now - (self._last or now), now
        for axis in (0, 1):
            current = self.torque[axis] / TORQUE_CONSTANT if self.state[axis] == 8 else 0.0
            self.speed[axis] += (SPEED_PER_AMPERE * current - self.speed[axis]) * min(
                1.0, passed / LAG
            )
            self.turns[axis] += self.speed[axis] * passed / (2 * pi)
            self._say(axis, 20, current, current)
            self._say(axis, 21, 30.0, 41.0 + axis)
            self._say(axis, 9, self.turns[axis], self.speed[axis] / (2 * pi))

    def _say(self, axis, command, first, second):
        self.bus.send(
            can.Message(
                arbitration_id=axis << 5 | command,
                data=struct.pack("<ff", first, second),
                is_extended_id=False,
            )
        )
