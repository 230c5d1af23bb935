"""Effort and motion on one clock: the delay between them, and what exceeds it.

A controller holds its effort for a cycle, a drive answers one cycle later, channels are logged one
after the other: no log is aligned to better than a sample.  Not fitted, that is friction, a lag or
an efficiency to whatever effect is free to follow it.
"""

from spirob.machine.models import Model
from spirob.machine.rig import Bounded, RigFile

# So far apart two channels of one log may be: a sample for the effort held over a cycle, one for
# the drive's answer, one for the order of logging; of a slow log the last alone
ROWS, FEW = 3.2, 1.5
LEAST, LONG = 1e-3, 0.02  # s: always possible, and beyond which it takes a slow log
# of the delay by which a time acts there
SIGNS = {"sensing.current": 1.0, "sensing.report": 1.0, "sensing.frame": -1.0}


def with_delay(rig: RigFile, period: float) -> RigFile:
    """The rig with a delay between effort and motion to fit, where the description names none."""
    if "delay" in rig.fit or "delay" in rig.known:
        return rig
    most = max(min(ROWS * period, LONG), FEW * period, LEAST)
    return rig.model_copy(
        update={"fit": {**rig.fit, "delay": Bounded(nominal=0.0, low=-most, high=most)}}
    )


def only_aligns(model: Model, rig: RigFile) -> bool:
    """Whether a lag or latency of a model is no more than logs are apart anyway.

    Against a delay of the other sign it does nothing but smooth, and whatever smooths a model of
    noisy motion fits better.
    """
    if "delay" not in rig.fit:
        return False
    most, delay = rig.fit["delay"].high, model.fit.changes["rig.delay"]
    for effect in model.effects:
        times = [f for f in effect.neutral if effect.parameters()[f].unit == "s"]
        for field in times if effect.port in SIGNS else ():
            age = model.fit.changes[f"{effect.name()}.{field}"]
            if age + SIGNS[effect.port] * delay <= most:
                return True
    return False
