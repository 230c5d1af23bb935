"""Drives on a virtual bus, served by a thread of their own: what all pretended ones share."""

import threading
import time

import can


class Served:
    """A context manager; `answer` is called for every message while it is open."""

    def __init__(self, channel):
        self.bus = can.Bus(interface="virtual", channel=channel)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._serve, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *error):
        self._stop.set()
        self._thread.join()
        self.bus.shutdown()

    def answer(self, message):
        """Take in one message, and say what is to be said."""
        raise NotImplementedError

    def answered(self, late):
        """A message is taken in that long after it was sent [s]."""

    def say(self, number, data):
        """Send a frame."""
        self.bus.send(can.Message(arbitration_id=number, data=data, is_extended_id=False))

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
            if message is not None:
                self.answered(time.time() - message.timestamp)
                self.answer(message)
