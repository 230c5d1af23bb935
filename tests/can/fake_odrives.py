"""Two ODrive axes on a virtual bus: torque in, estimates and currents out, floats throughout."""

import struct
import time
from math import pi

from tests.can.served import Served

TORQUE_CONSTANT = 0.0203
SPEED_PER_AMPERE = 4.0  # rotor rad/s, with a lag; slow, so that a stall hides no whole turn
LAG = 0.05


class FakeODrives(Served):
    """Moves only in closed loop (axis state 8); answers when both torques of a cycle are there."""

    def __init__(self, channel):
        super().__init__(channel)
        self.state, self.torque = [1, 1], [0.0, 0.0]
        self.speed, self.turns = [0.0, 0.0], [5.2, -3.7]
        self.torques, self.heard = [], []
        self._last = None

    def answer(self, message):
        axis, command = message.arbitration_id >> 5, message.arbitration_id & 31
        self.heard.append((axis, command))
        if command == 7:
            self.state[axis] = struct.unpack_from("<I", message.data)[0]
        elif command == 14:
            self.torque[axis] = struct.unpack_from("<f", message.data)[0]
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
            self._estimates(axis, 20, current, current)
            self._estimates(axis, 21, 30.0, 41.0 + axis)
            self._estimates(axis, 9, self.turns[axis], self.speed[axis] / (2 * pi))

    def _estimates(self, axis, command, first, second):
        self.say(axis << 5 | command, struct.pack("<ff", first, second))
