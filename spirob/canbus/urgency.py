"""The loop's claim on the computer: real-time priority, and no collection of garbage meanwhile."""

import gc
import os
import sys

SWITCH = 1e-4  # s: how long another thread, the log's, may hold the interpreter at a stretch
PRIORITY = 50  # of SCHED_FIFO: above everything that is not real-time, below the kernel's own


class Urgency:
    """Taken when the loop begins, given back when it ends; both safe to call twice.

    lacking  a sentence where the system does not allow it, else empty
    """

    def __init__(self) -> None:
        self.lacking = ""
        self._taken = False
        self._before: tuple[int, os.sched_param] | None = None
        self._collecting = gc.isenabled()
        self._switch = sys.getswitchinterval()

    def take(self) -> None:
        """Claim what the system allows."""
        if self._taken:
            return
        self._taken, self._collecting = True, gc.isenabled()
        self._switch = sys.getswitchinterval()
        sys.setswitchinterval(SWITCH)
        gc.collect()
        gc.freeze()
        gc.disable()
        if not hasattr(os, "sched_setscheduler"):
            self.lacking = "this system has no real-time priority to give"
            return
        before = (os.sched_getscheduler(0), os.sched_getparam(0))
        try:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
        except OSError as error:
            self.lacking = f"no real-time priority: {error.strerror}; see docs/hardware.md"
        else:
            self._before = before

    @property
    def said(self) -> str:
        """What the loop runs with, in a phrase."""
        return self.lacking or f"SCHED_FIFO {PRIORITY}, no garbage collection in the loop"

    def give_back(self) -> None:
        """Leave everything as it was."""
        if not self._taken:
            return
        self._taken = False
        sys.setswitchinterval(self._switch)
        if self._before:
            os.sched_setscheduler(0, *self._before)
            self._before = None
        gc.unfreeze()
        if self._collecting:
            gc.enable()
