"""A trial stopped for safety, and Ctrl-C and SIGTERM between two cycles."""

import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from types import FrameType

from spirob.can_protocol import CanFrame
from spirob.errors import HardwareError


class Stopped(HardwareError):
    """The current is zero again, and says why; `frames` arrived in the cycle that it ended."""

    def __init__(self, reason: str, frames: Sequence[CanFrame] = ()):
        super().__init__(reason)
        self.frames = list(frames)


SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)


@contextmanager
def interruptible() -> Iterator[Callable[[], None]]:
    """A function to call once a cycle: it raises where a signal has come since.

    Ctrl-C is raised as KeyboardInterrupt, any other as SystemExit with code 128 + its number.  A
    second signal is raised where the program stands, for a loop that has got stuck.  Outside of
    the main thread signals stay as they are.
    """
    came: list[int] = []

    def handle(number: int, frame: FrameType | None) -> None:
        came.append(number)
        if len(came) > 1:
            raise _error(number)

    def check() -> None:
        if came:
            raise _error(came[0])

    if threading.current_thread() is not threading.main_thread():
        yield check
        return
    before = {number: signal.signal(number, handle) for number in SIGNALS}
    try:
        yield check
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _error(number: int) -> BaseException:
    return KeyboardInterrupt() if number == signal.SIGINT else SystemExit(128 + number)
