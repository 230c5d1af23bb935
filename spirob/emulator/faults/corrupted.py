"""Frames with a flipped bit that no checksum catches."""

from dataclasses import replace

from spirob.can_protocol import CanFrame
from spirob.emulator.faults import Course, Fault
from spirob.parameter import bounded


class Corrupted(Fault):
    """A fault before the checksum is made: in a drive's firmware or in the adapter's memory."""

    probability: float = bounded(0.01, 0.0, 1.0, "1", "p", "of each frame")

    def on_bus(self, frame: CanFrame, course: Course) -> list[CanFrame]:
        """The frame, now and then with one bit of its payload flipped."""
        if not course.happens(self.probability):
            return [frame]
        bit = int(course.rng.integers(8 * len(frame.data)))
        changed = bytearray(frame.data)
        changed[bit // 8] ^= 1 << bit % 8
        return [replace(frame, data=bytes(changed))]
