"""Perception from a bus while it happens; it listens and says nothing on the bus.

`Watch` tells contact of either motor, the size of what one of them wraps, and pushes, from frames.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import pandas as pd

from spirob.can_protocol import FEEDBACK_ID, CanFrame
from spirob.errors import DataError
from spirob.logs.cycles import Transmission
from spirob.perceive.contact import ContactDetector, ContactSettings
from spirob.perceive.features import extract
from spirob.perceive.interval import CONFIDENCE, Estimate, estimate
from spirob.perceive.live_signals import Grid, LivePush, LiveWrap, Motion, Sample
from spirob.perceive.size import SizeModel
from spirob.robot import CYCLE_NS, MOTORS
from spirob.safety.motor import MotorState
from spirob.trace import Trace

SETTLE = 300  # samples of a motion before its detector listens: the start is a rise of its own
NEVER = 2**62  # samples
FRAME_BYTES = 8


@dataclass(frozen=True)
class Told:
    """Something to be told.

    seconds  since the first frame;  motor  left, right, or both
    kind     "contact", "size", "no size", "push", "no push" where one was felt and the feedback is
             missing, or "gap" where the bus was silent for a while
    text     in words
    """

    seconds: float
    motor: str
    kind: str
    text: str


class Watch:
    """Takes in C620-style frames and tells contacts and sizes; it never sends.

    A detector listens to a motor that winds in, or stands after it did, or has not moved yet; not
    to one that pays out, whose current rises by itself when it stops.

    transmission  nominal gear and winch of both motors;  rules  of the contact detectors
    model         of sizes; None where only contacts are wanted;  wraps  the motor that wraps
    push          tells pushes of motors that hold their currents; None where it is not wanted
    """

    def __init__(
        self,
        transmission: Transmission | None = None,
        rules: ContactSettings | None = None,
        model: SizeModel | None = None,
        wraps: str = "left",
        confidence: float = CONFIDENCE,
        push: LivePush | None = None,
    ):
        self.states = [MotorState() for _ in MOTORS]
        self.contact: list[str] = ["" for _ in MOTORS]  # what is touched now, in words
        self.size = ""
        self.frames = [0 for _ in MOTORS]
        gear = transmission or Transmission()
        self._scale = gear.metre_per_count, gear.metre_per_second_per_rpm
        self._grids = [Grid() for _ in MOTORS]
        self._motions = [Motion() for _ in MOTORS]
        self._detectors = [ContactDetector(rules, CYCLE_NS / 1e9) for _ in MOTORS]
        self._deaf = [0 for _ in MOTORS]
        self._model, self._confidence = model, confidence
        self._wraps = MOTORS.index(wraps)
        self._wrap = LiveWrap(wraps)
        self._first_ns: int | None = None
        self.push = push

    def take(self, frame: CanFrame) -> list[Told]:
        """Take in one frame; frames of others, and those of another length, say nothing."""
        m = frame.arbitration_id - FEEDBACK_ID - 1
        if not 0 <= m < len(MOTORS) or len(frame.data) != FRAME_BYTES:
            return []
        if self._first_ns is None:
            self._first_ns = frame.stamp_ns
        self.frames[m] += 1
        state = self.states[m]
        state.update(frame.data, frame.stamp_ns, *self._scale)
        sample = Sample(state.displacement, state.velocity, state.current)
        samples = self._grids[m].take(frame.stamp_ns, sample)
        found = self._broken(m) if self._grids[m].broken else []
        for one in samples:
            found += self._contact(m, one) + self._size(m, one)
        seconds = (frame.stamp_ns - self._first_ns) / 1e9
        pushed = self.push.take(m, samples) if self.push else []
        both = [Told(seconds, "both", kind, text) for kind, text in pushed]
        return [Told(seconds, MOTORS[m], kind, text) for kind, text in found] + both

    def _broken(self, m: int) -> list[tuple[str, str]]:
        self._detectors[m].reset()
        self.contact[m] = ""
        if self.push:
            self.push.forget()
        if m == self._wraps:
            self._wrap.forget()
        return [("gap", "no feedback for a while; contact and size begin anew")]

    def _contact(self, m: int, sample: Sample) -> list[tuple[str, str]]:
        detector = self._detectors[m]
        if self._motions[m].begins(sample.velocity):
            detector.reset()
            winds_in = self._motions[m].direction > 0
            self._deaf[m], self.contact[m] = SETTLE if winds_in else NEVER, ""
            if m == self._wraps and winds_in:
                self._wrap.begin()
        if self._deaf[m] > 0:
            self._deaf[m] -= 1
            return []
        known = detector.contact
        now = detector.update(sample.current)
        if now is None or known is not None:
            return []
        self.contact[m] = f"{now.rise:+.2f} A over {now.baseline:.2f} A, {now.slope:.1f} A/s"
        return [("contact", f"{self.contact[m]} ({now.rule} rule)")]

    def _size(self, m: int, sample: Sample) -> list[tuple[str, str]]:
        if self._model is None or m != self._wraps:
            return []
        ended = self._wrap.take(sample)
        if ended is None:
            return []
        try:
            found = self._estimate(self._model, ended)
        except DataError as error:
            return [("no size", str(error))]
        if found.refusal:
            return [("no size", found.refusal)]
        low, high = 1e3 * found.low, 1e3 * found.high
        self.size = f"{1e3 * found.diameter:.1f} mm ({low:.1f} to {high:.1f} mm)"
        return [("size", self.size)]

    def _estimate(self, model: SizeModel, ended: Trace) -> Estimate:
        features = extract(ended, MOTORS[self._wraps], model.features)
        row = pd.DataFrame([features], index=[ended.name])
        return estimate(model, row, self._confidence)[0]


def told(watch: Watch, frames: Sequence[CanFrame]) -> list[Told]:
    """All that a watch tells of some frames, such as those of a recorded bus."""
    return [one for frame in frames for one in watch.take(frame)]
