"""The drive smooths the current before it reports it."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class CurrentLag(Effect):
    """T·dy/dt = i - y: a first-order filter, exact for a current constant within the cycle."""

    port = "sensing.report"
    state = {"filtered": 0.0}
    free = ("filtered",)
    neutral = {"time": 0.0}
    equation = "filtered"
    evolution = {"filtered": "(upstream - filtered)/T"}
    title = "smoothing of the reported current"
    signature = (
        "The measured current trails the load at every change, and agrees when nothing moves."
    )
    explanation = "The firmware filters the current, so that the log shows it late and rounded."
    tell_apart = {
        "feedback_latency": "fast changes: smoothing rounds them, latency only shifts them",
        "joint_viscoelasticity": "current against command: smoothing shows there too",
    }
    needs = "changes of current within a few tens of milliseconds"
    references = ("Åström, Wittenmark, Computer-Controlled Systems, ch. 2 (1997)",)

    time: float = bounded(0.01, 0.0, 0.2, "s", "T", "time constant of the filter")

    @staticmethod
    def kernel(upstream, filtered, time, dt):
        """Measured current [A] and the filter's next state [A]."""
        if time <= 0.0:
            return upstream, upstream
        filtered = upstream + (filtered - upstream) * math.exp(-dt / time)
        return filtered, filtered
