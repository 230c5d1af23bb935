"""The loop's claim on the computer, and how late its cycles ended."""

import gc
import os
import sys
from array import array

import numpy as np

EDGES = (0, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000)  # µs, the last bin is open


class Lateness:
    """One number for each cycle [ns]; 8 bytes each."""

    def __init__(self) -> None:
        self._late = array("q")

    def ended(self, late_ns: int) -> None:
        """A cycle has come to its end that long after its deadline."""
        self._late.append(late_ns)

    def restart(self) -> None:
        """Forget everything, for another trial."""
        del self._late[:]

    def summary(self) -> dict[str, str]:
        """Number of cycles, median, 99 % and most [µs], and how many in each bin from `EDGES`."""
        late = np.maximum(np.frombuffer(self._late, np.int64), 0) / 1e3
        if not len(late):
            return {}
        counts, _ = np.histogram(late, [*EDGES, np.inf])
        middle, most_of = np.percentile(late, (50, 99))
        return {
            "cycles": str(len(late)),
            "lateness_p50_us": f"{middle:.1f}",
            "lateness_p99_us": f"{most_of:.1f}",
            "lateness_max_us": f"{late.max():.1f}",
            "histogram_from_us": " ".join(map(str, EDGES)),
            "histogram": " ".join(map(str, counts)),
        }


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
