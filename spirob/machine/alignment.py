"""Effort and motion on one clock: the delay between them, how large it may be, what exceeds it.

A controller holds its effort for a cycle, a drive answers one cycle later, channels are logged one
after the other: no log is aligned to better than a sample.  A filter, a bus or a logger may delay a
channel by tens of milliseconds besides.  Not fitted, that is friction, a lag, an elastic gear or an
efficiency to whatever effect is free to follow it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from spirob.machine.models import Model
from spirob.machine.recording import Recording
from spirob.machine.rig import Bounded, RigFile

# So far apart two channels of one log may be: a sample for the effort held over a cycle, one for
# the drive's answer, one for the order of logging; of a slow log the last alone
ROWS, FEW = 3.2, 1.5
LEAST, LONG = 1e-3, 0.02  # s: always possible, and beyond which it takes a slow log
FARTHEST = 0.06  # s; public logs of real machines hold 16 to 50 ms
# of the delay by which a time acts there
SIGNS = {"sensing.current": 1.0, "sensing.report": 1.0, "sensing.frame": -1.0}


def usual(period: float) -> float:
    """Seconds by which effort and motion of any log may be apart, for its sample period."""
    return max(min(ROWS * period, LONG), FEW * period, LEAST)


def as_usual(period: float) -> Bounded:
    """A delay to fit that is no more than that of any log."""
    most = usual(period)
    return Bounded(nominal=0.0, low=-most, high=most)


def is_told(rig: RigFile) -> bool:
    """Whether the description says what to make of the delay."""
    return "delay" in rig.known or "delay" in rig.fit


def partnered(rig: RigFile, recordings: Sequence[Recording]) -> list[Recording]:
    """The trials without rows that the rig's delay, at most, leaves no partner.

    They are at the ends of pieces; where all of a trial is, nothing is left out.
    """
    fitted = rig.fit.get("delay")
    known = abs(rig.known.get("delay", 0.0))
    farthest = known if fitted is None else max(fitted.high, -fitted.low)
    cut = [inside(r, farthest) for r in recordings]
    return cut if all(r.pieces for r in cut) else list(recordings)


def inside(recording: Recording, delay: float) -> Recording:
    """The trial without the rows that a delay of this size, either way, leaves no partner."""
    ends = round(delay / recording.period)
    cut = [replace(p, use=p.use & _within(len(p.q), ends)) for p in recording.pieces]
    return replace(recording, pieces=recording.worth(cut))


def only_aligns(model: Model, rig: RigFile, period: float) -> bool:
    """Whether a lag or latency of a model is no more than logs are apart anyway.

    Against a delay of the other sign it does nothing but smooth, and whatever smooths a model of
    noisy motion fits better.
    """
    if "delay" not in rig.fit:
        return False
    told = rig.fit["delay"]
    most = min(told.high - told.nominal, usual(period))
    delay = model.fit.changes["rig.delay"] - told.nominal
    for effect in model.effects:
        times = [f for f in effect.neutral if effect.parameters()[f].unit == "s"]
        for field in times if effect.port in SIGNS else ():
            age = model.fit.changes[f"{effect.name()}.{field}"]
            if age + SIGNS[effect.port] * delay <= most:
                return True
    return False


def _within(n: int, ends: int) -> np.ndarray:
    at = np.arange(n)
    return (at >= ends) & (at < n - ends)
