"""A trial in a process of its own, in real time, that tells every command it sent.

python -m tests.trials.stopped_trial FOLDER SENT
"""

import os
import struct
import sys
import time
from pathlib import Path

from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import plain_trial, record_on


class Telling(FakeRobot):
    """Writes each command to a file before it takes effect, one a millisecond."""

    def __init__(self, path):
        super().__init__()
        self.told = os.open(path, os.O_WRONLY | os.O_CREAT)

    def exchange(self, command):
        os.write(self.told, command)
        time.sleep(0.0009)
        return super().exchange(command)


def commands(path):
    """All commands that were sent, in counts of the left and the right motor."""
    content = Path(path).read_bytes()
    return [row[:2] for row in struct.iter_unpack(">4h", content[: len(content) // 8 * 8])]


if __name__ == "__main__":
    motors = plain_trial()["motors"]
    motors["left"] = dict(motors["right"])
    record_on(Telling(sys.argv[2]), Path(sys.argv[1]), 30.0, motors=motors)
