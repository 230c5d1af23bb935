"""The feedback frame is old when it arrives."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class FeedbackLatency(Effect):
    """y(t) = u(t - T) for every reading of the frame, T up to eight cycles.

    A true dead time: the last readings are kept, and a fraction of a cycle is interpolated between
    two of them.  Controller and log both get the old readings.
    """

    port = "sensing.frame"
    state = {f"old_{k}": 0.0 for k in range(1, 9)}
    neutral = {"latency": 0.0}
    title = "latency of the feedback"
    signature = "All readings trail the command by the same time; fast feedback gets restless."
    explanation = (
        "The drive's sampling, its processor and the bus hold every frame back for a few cycles."
    )
    tell_apart = {
        "current_lag": "fast changes: latency only shifts them, smoothing rounds them",
    }
    needs = "quick changes of command, with command and feedback on one clock"
    references = ("Franklin, Powell, Workman, Digital Control of Dynamic Systems, ch. 3 (1998)",)

    latency: float = bounded(0.002, 0.0, 0.008, "s", "T", "age of a reading on arrival")

    @staticmethod
    def kernel(upstream, old_1, old_2, old_3, old_4, old_5, old_6, old_7, old_8, latency, dt):
        """The reading of some cycles ago, and the readings kept for the next cycle."""
        known = (upstream, old_1, old_2, old_3, old_4, old_5, old_6, old_7, old_8, old_8)
        age = min(latency / dt, 8.0)
        newer = int(age)
        late = known[newer] + (age - newer) * (known[newer + 1] - known[newer])
        return late, upstream, old_1, old_2, old_3, old_4, old_5, old_6, old_7
