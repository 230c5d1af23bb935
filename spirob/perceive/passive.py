"""A push felt in the current of motors that are told to hold it, sample by sample.

    Σ ((i - i_0)/max(σ, σ_min))² > n²    over both motors, for `confirm` seconds

i is the mean of the last `smoothing` seconds, i_0 and σ its slow mean and deviation while nothing
is felt; they are learned for `settle` seconds, after `wait` for the motors to take their currents,
and again after each push, for the arm swings on. What a push does in the `window` from just before
it on is told as `Response`, which says where along the arm it was: base, middle or tip, from
current and angle.  The `features` for that are the same whichever side is pushed: of both motors
the larger entry, then the smaller. Sizes are taken as logarithms, for a push of another strength
scales them all.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sklearn.linear_model import LogisticRegression
from sklearn.pipeline import Pipeline, make_pipeline
from sklearn.preprocessing import StandardScaler

from spirob.parameter import Numbers, bounded

OUTLIER = 3.0  # deviations; what is beyond is learned from as if it were there


class PassiveSettings(Numbers):
    """Thresholds and windows of the passive detector."""

    owner = "passive"

    times: float = bounded(5.5, 1.0, 100.0, "1", "n", "deviations of the undisturbed current")
    least: float = bounded(0.0005, 1e-6, 10.0, "A", "σ_min", "least deviation, half a count")
    smoothing: float = bounded(0.031, 0.001, 0.5, "s", "T_s", "of the present level")
    baseline: float = bounded(0.3, 0.01, 30.0, "s", "T_0", "of the slow mean and deviation")
    wait: float = bounded(0.3, 0.0, 30.0, "s", "T_a", "until anything is learned")
    settle: float = bounded(0.5, 0.05, 30.0, "s", "T_l", "learning, deaf")
    confirm: float = bounded(0.003, 0.0, 0.1, "s", "T_c", "the rule has to hold this long")
    window: float = bounded(0.25, 0.02, 5.0, "s", "T_w", "after it, in which a push is described")
    before: float = bounded(0.05, 0.0, 1.0, "s", "T_b", "before it, which belongs to it")


@dataclass(frozen=True)
class Response:
    """What a push did, one entry for each motor.

    sample  at which it was felt, counted from the start
    peak    largest departure of the current [A];  peak_after  its time from the window's start [s]
    travel  largest change of the tendon's length [m];  travel_after  its time [s]
    swing   of that length within the window, least to most [m]
    """

    sample: int
    peak: np.ndarray
    peak_after: np.ndarray
    travel: np.ndarray
    travel_after: np.ndarray
    swing: np.ndarray


class PassiveDetector:
    """Takes in currents and lengths once a period [s]; `felt` as soon as a push is told."""

    def __init__(self, rules: PassiveSettings | None = None, period: float = 1e-3):
        self._rules, self._period = rules or PassiveSettings(), period
        r, self.felt, self._sample = self._rules, False, -1
        self._level: deque[np.ndarray] = deque(maxlen=self._samples(r.smoothing))
        self._past: deque[tuple[np.ndarray, np.ndarray]] = deque(maxlen=self._samples(r.before))
        self._mean = self._square = np.zeros(0)  # of nothing: learned with the next sample
        self._held, self._told = 0, 0
        self._first = self._samples(r.wait) + self._samples(r.smoothing)
        self._during: list[tuple[np.ndarray, np.ndarray]] = []

    def _samples(self, seconds: float) -> int:
        return max(1, round(seconds / self._period))

    def update(self, currents: Sequence[float], lengths: Sequence[float]) -> Response | None:
        """One sample: currents [A], wound-in lengths [m]; the response once its window is over."""
        self._sample += 1
        self._level.append(np.asarray(currents, float))
        now = (np.mean(self._level, axis=0), np.asarray(lengths, float))
        if self.felt:
            self._during.append(now)
            full = len(self._during) >= self._samples(self._rules.window) + len(self._past)
            return self._response() if full else None
        self._past.append(now)
        if self._sample < self._first:
            return None
        apart = self._learned(now[0])
        self._held = self._held + 1 if apart else 0
        if self._held > self._samples(self._rules.confirm):
            self.felt, self._told, self._held = True, self._sample, 0
            self._during = list(self._past)
        return None

    def _learned(self, level: np.ndarray) -> bool:
        """Whether a level departs; one that does not is learned from."""
        if not len(self._mean):
            self._mean, self._square = level, np.zeros_like(level)
        off, r = level - self._mean, self._rules
        seen = self._sample - self._first
        deaf = seen < self._samples(r.settle)
        deviations = off / np.maximum(np.sqrt(self._square), r.least)
        if not deaf and deviations @ deviations > r.times**2:
            return True
        share = self._period / r.baseline
        if deaf:  # a plain mean until there is enough for a slow one
            share = max(share, 1.0 / (seen + 1))
        else:  # the beginning of a push must not pass for noise
            most = OUTLIER * np.maximum(np.sqrt(self._square), r.least)
            off = np.clip(off, -most, most)
        self._mean = self._mean + share * off
        self._square = (1.0 - share) * (self._square + share * off**2)
        return False

    def _response(self) -> Response:
        level, length = (np.array(part) for part in zip(*self._during, strict=True))
        off, moved = np.abs(level - self._mean), np.abs(length - length[0])
        self.felt = False
        self._past.clear()
        self._mean, self._first = np.zeros(0), self._sample + 1  # the arm still swings
        return Response(
            self._told,
            off.max(axis=0),
            off.argmax(axis=0) * self._period,
            moved.max(axis=0),
            moved.argmax(axis=0) * self._period,
            np.ptp(length, axis=0),
        )


REGIONS = ("base", "middle", "tip")
BORDERS = (1 / 3, 2 / 3)  # of the length
LEAST_CURRENT, LEAST_LENGTH = 1e-4, 1e-6  # A, m: what is below is as good as nothing


def region(place: float) -> str:
    """The region of a place, as a share of the arm's length from the base."""
    return REGIONS[int(np.searchsorted(BORDERS, place, side="right"))]


def features(response: Response) -> np.ndarray:
    """Numbers that tell where a push was, in the order in which the classifier takes them."""
    sizes = [_sorted(response.peak, LEAST_CURRENT)]
    sizes += [_sorted(v, LEAST_LENGTH) for v in (response.travel, response.swing)]
    whole = np.concatenate(sizes)
    strongest = int(np.argmax(response.peak))
    times = response.peak_after[strongest], response.travel_after[strongest]
    return np.concatenate([whole, [whole[0] - whole[2]], times])


def _sorted(values: np.ndarray, least: float) -> np.ndarray:
    return np.log(np.maximum(np.sort(values)[::-1], least))


def learned(responses: Sequence[Response], places: Sequence[float]) -> Pipeline:
    """A classifier of regions from pushes at known places."""
    made = make_pipeline(StandardScaler(), LogisticRegression(C=10.0, max_iter=5000))
    made.fit(np.array([features(r) for r in responses]), [region(p) for p in places])
    return made
