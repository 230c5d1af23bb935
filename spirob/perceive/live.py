"""Perception from a bus while it happens; it listens and says nothing on the bus.

`Watch` tells contact of either motor, the size of what one of them wraps, and pushes, from frames.

Every rule and every feature counts samples.  `Grid` is anchored where the first frame came, so that
lateness does not add up: of two frames in one period the later one is passed over, and up to
`LONGEST` lost ones are filled by a straight line.  A longer silence begins a new grid.

`LiveWrap` is a wrap as it grows.  The tendon stands soon; the current goes on rising to the limit
of its command, and sizes are read at shares of that rise.  So the wrap is over when the tendon
stands and the current is steady.  What was taken in is then read as a log would be
(`perceive.wrap`), so the same sentences tell why a motion was no wrap.

`LivePush` tells pushes of an arm whose motors hold their currents.  What is not heard is not
guessed: after `PATIENCE` without a sample of either motor nothing is felt any more, and the
undisturbed current is learned anew.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd
from sklearn.pipeline import Pipeline

from spirob.can.motor import MotorState
from spirob.can_protocol import FEEDBACK_ID, CanFrame
from spirob.errors import DataError
from spirob.logs.cycles import Transmission
from spirob.logs.trace import Trace
from spirob.perceive.contact import ContactDetector
from spirob.perceive.features import SECONDS, extract
from spirob.perceive.interval import Estimate, estimate
from spirob.perceive.passive import PassiveDetector, Response, features
from spirob.perceive.size import SizeModel
from spirob.perceive.wrap import LEAST_STROKE, STILL_MOVING
from spirob.robot import CYCLE_NS, MOTORS

LONGEST = 50  # periods


class Sample(NamedTuple):
    """One motor at one instant: displacement [m], velocity [m/s], current [A]."""

    displacement: float
    velocity: float
    current: float


class Grid:
    """Regular samples of one motor, every `CYCLE_NS`."""

    def __init__(self) -> None:
        self.broken = False  # whether the last `take` had to begin anew
        self._zero_ns = self._number = 0
        self._last: Sample | None = None

    def take(self, stamp_ns: int, sample: Sample) -> list[Sample]:
        """The samples that are known with this one, in order; often one, sometimes none."""
        number = round((stamp_ns - self._zero_ns) / CYCLE_NS)
        before, self.broken = self._last, False
        if before is None or not -LONGEST <= number - self._number <= LONGEST:
            self.broken = before is not None
            self._zero_ns, self._number, self._last = stamp_ns, 0, sample
            return [sample]
        steps = number - self._number
        if steps <= 0:
            return []
        self._number, self._last = number, sample
        return [_between(before, sample, k / steps) for k in range(1, steps)] + [sample]


def _between(one: Sample, other: Sample, share: float) -> Sample:
    return Sample(*(a + share * (b - a) for a, b in zip(one, other, strict=True)))


MOVES = 5e-3  # m/s
RESTS = 2e-3  # m/s
SUSTAINED = 20e6 / CYCLE_NS  # samples; a drive's speed is noisy


class Motion:
    """Which way a motor moves: +1 winds in, -1 pays out, 0 rests."""

    def __init__(self) -> None:
        self.direction = 0
        self._candidate = 0
        self._held = 0

    def begins(self, velocity: float) -> bool:
        """Take in one sample [m/s]; whether a new motion begins with it."""
        if abs(velocity) < RESTS:
            now = 0
        elif abs(velocity) > MOVES:
            now = 1 if velocity > 0 else -1
        else:
            now = self.direction
        self._held = self._held + 1 if now == self._candidate else 1
        self._candidate = now
        if now == self.direction or self._held < SUSTAINED:
            return False
        self.direction = now
        return now != 0


BEFORE = 300  # samples kept from before the motion
STANDS = 500  # samples
STEADY = 300  # samples, whose mean current is compared with that of as many before
SAME = 0.01  # of the current
LEAST = BEFORE + round(SECONDS * 1e9 / CYCLE_NS)  # samples: spectra have a window of their own
LONGEST_WRAP = 60_000  # samples
SIGNALS = {"displacement": "m", "velocity": "m/s", "current": "A"}


class LiveWrap:
    """Collects one motor's samples; `take` gives a trace where a wrap, or what may be one, ends."""

    def __init__(self, motor: str):
        self._motor = motor
        self._before: deque[Sample] = deque(maxlen=BEFORE)
        self.forget()

    def forget(self) -> None:
        """Nothing is being wrapped."""
        self._samples: list[Sample] = []
        self._fastest = 0.0
        self._standing = 0
        self._before.clear()

    def begin(self) -> None:
        """The motor has begun to wind in."""
        if not self._samples:
            self._samples = list(self._before)

    def take(self, sample: Sample) -> Trace | None:
        """Take in a sample; the trace of the motion if it has just ended."""
        if not self._samples:
            self._before.append(sample)
            return None
        self._samples.append(sample)
        self._fastest = max(self._fastest, sample.velocity)
        still = abs(sample.velocity) <= STILL_MOVING * self._fastest
        self._standing = self._standing + 1 if still else 0
        if not self._over():
            return None
        motion = np.array(self._samples)
        self.forget()
        if np.ptp(motion[:, 0]) < LEAST_STROKE:  # a twitch
            return None
        channels = dict(zip(SIGNALS, motion.T, strict=True))
        return Trace(
            "what was wound in",
            np.arange(len(motion), dtype=np.int64) * CYCLE_NS,
            {f"{self._motor}.{name}": values for name, values in channels.items()},
            {f"{self._motor}.{name}": unit for name, unit in SIGNALS.items()},
        )

    def _over(self) -> bool:
        count = len(self._samples)
        if count >= LONGEST_WRAP:
            return True
        # steadiness is looked at now and then only, for it costs more than the rest
        if self._standing < STANDS or count < LEAST or count % 20:
            return False
        current = np.array([s.current for s in self._samples[-2 * STEADY :]])
        before, now = float(current[:STEADY].mean()), float(current[STEADY:].mean())
        return abs(now - before) <= SAME * abs(now)


PATIENCE = 10  # samples


class LivePush:
    """Pairs the motors' samples and tells pushes; `classifier` tells where."""

    def __init__(self, classifier: Pipeline):
        self._classifier = classifier
        self.forget()

    def forget(self) -> None:
        """Nothing is felt, nothing has been learned."""
        self._waiting: list[deque[Sample]] = [deque() for _ in MOTORS]
        self._detector = PassiveDetector(period=CYCLE_NS / 1e9)

    @property
    def felt(self) -> bool:
        """Whether a push is being felt."""
        return self._detector.felt

    def take(self, motor: int, samples: Sequence[Sample]) -> list[tuple[str, str]]:
        """Samples of one motor; kinds and words of what is told with them."""
        waiting = self._waiting
        waiting[motor].extend(samples)
        if len(samples) > PATIENCE or max(map(len, waiting)) > PATIENCE:
            told = [("no push", "feedback is missing; it listens anew")] if self.felt else []
            self.forget()
            return told
        found: list[tuple[str, str]] = []
        while all(waiting):
            pair = [one.popleft() for one in waiting]
            before = self.felt
            response = self._detector.update(
                [s.current for s in pair], [s.displacement for s in pair]
            )
            if self.felt and not before:
                found.append(("push", "felt"))
            if response is not None:
                found.append(("push", self._where(response)))
        return found

    def _where(self, response: Response) -> str:
        shares = self._classifier.predict_proba([features(response)])[0]
        k = int(np.argmax(shares))
        peak = 1e3 * float(response.peak.max())
        return f"{self._classifier.classes_[k]} ({shares[k]:.0%}), {peak:.0f} mA at most"


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

    transmission  nominal gear and winch of both motors
    model         of sizes; None where only contacts are wanted;  wraps  the motor that wraps
    push          tells pushes of motors that hold their currents; None where it is not wanted
    """

    def __init__(
        self,
        transmission: Transmission | None = None,
        model: SizeModel | None = None,
        wraps: str = "left",
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
        self._detectors = [ContactDetector(period=CYCLE_NS / 1e9) for _ in MOTORS]
        self._deaf = [0 for _ in MOTORS]
        self._model = model
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
        return estimate(model, row)[0]
