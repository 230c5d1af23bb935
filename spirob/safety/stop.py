"""The error of a trial that was stopped for safety."""

from collections.abc import Sequence

from spirob.can_protocol import CanFrame
from spirob.errors import HardwareError


class Stopped(HardwareError):
    """The current is zero again, and says why; `frames` arrived in the cycle that it ended."""

    def __init__(self, reason: str, frames: Sequence[CanFrame] = ()):
        super().__init__(reason)
        self.frames = list(frames)
