"""When a signal answers, the recoil from a contact, and how far two currents are apart.

The recoil begins as soon as the detector speaks: the trial then goes on with its last part.  A
model may also repeat the motion of another side, and recoil when that one did.

How far a model's current is off the robot's is asked in one motion and in each side's own.  When a
detector speaks and what a current is are two questions.  In one motion the model moves as the robot
did and recoils when it did.  Each in its own, a recoil that comes at another time counts as error;
there the robot is played several times, and its plays against each other say how much of such an
error is its own.
"""

from collections import deque
from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from spirob.experiments import WINDOW, Side, repeating, row
from spirob.perceive.contact import ContactDetector, ContactSettings

PERIOD = 1e-3  # s, of every signal here
SETTLED = 5  # samples over which a noisy signal has to stay beyond a level


def smooth(values: np.ndarray, samples: int) -> np.ndarray:
    """Centred mean over an odd number of samples; ends repeat their last value."""
    half = samples // 2
    padded = np.pad(values, half, mode="edge")
    return np.convolve(padded, np.ones(2 * half + 1) / (2 * half + 1), mode="valid")


def crossing(values: np.ndarray, level: float) -> float:
    """First time [s] at which a signal reaches a level and stays for `SETTLED` samples.

    Between samples by a straight line; NaN where it never does.
    """
    beyond = values >= level
    run = np.convolve(beyond, np.ones(SETTLED), mode="valid") == SETTLED
    if not run.any():
        return float("nan")
    k = int(np.argmax(run))
    if k == 0:
        return 0.0
    step = values[k] - values[k - 1]
    return PERIOD * (k - 1 + float(np.clip((level - values[k - 1]) / step, 0.0, 1.0)))


def step_times(values: np.ndarray, begins: float, settled: tuple[float, float]) -> dict[str, float]:
    """Delay and rise of the answer to a step that is commanded at `begins` [s].

    The answer goes from the mean of the 0.1 s before to its mean between two times `settled` [s].
    delay  until half of it [s];  rise  from a tenth to nine tenths of it [s]
    """
    first = round(begins / PERIOD)
    start = float(np.mean(values[max(first - 100, 0) : first + 1]))
    last = slice(round(settled[0] / PERIOD), round(settled[1] / PERIOD))
    height = float(np.mean(values[last])) - start
    if height == 0.0:
        return {"delay": float("nan"), "rise": float("nan"), "height": 0.0}
    share = (values[first:] - start) / height
    tenth, half, most = (crossing(share, level) for level in (0.1, 0.5, 0.9))
    return {"delay": half, "rise": most - tenth, "height": height}


def strongest_period(values: np.ndarray, shortest: float, longest: float) -> float:
    """Period [s] of the strongest line of a signal without its trend, within two bounds [s].

    The signal is padded to eight times its length, so that lines lie close; NaN where it is flat.
    """
    n = len(values)
    time = np.arange(n)
    level = values - np.polyval(np.polyfit(time, values, 1), time)
    power = np.abs(np.fft.rfft(level * np.hanning(n), 8 * n)) ** 2
    frequency = np.fft.rfftfreq(8 * n, PERIOD)
    band = (frequency >= 1 / longest) & (frequency <= 1 / shortest)
    if power[band].max() <= 1e-24 * n:
        return float("nan")
    return float(1 / frequency[band][np.argmax(power[band])])


def amplitude(values: np.ndarray, period: float) -> float:
    """Amplitude of the line of that period in a signal without its trend, in the signal's unit."""
    n = round(int(len(values) * PERIOD / period) * period / PERIOD)  # whole periods
    time = np.arange(n) * PERIOD
    level = values[:n] - np.polyval(np.polyfit(time, values[:n], 1), time)
    return float(2 / n * abs(level @ np.exp(-2j * np.pi * time / period)))


DEPARTS = 0.025  # A: five times the sensor's noise
PARTED = 50  # samples


def onset(contact: np.ndarray, free: np.ndarray, first: int) -> float:
    """Time [s] at which a current parts from that of the same motion without contact.

    From a sample `first` on it has to be `DEPARTS` above for `PARTED` samples, or to the end, as a
    mean of 21; NaN where it never does.  The shorter current decides how far they are compared.
    """
    both = min(len(contact), len(free))
    apart = smooth(contact[:both] - free[:both], 21)[first:] > DEPARTS
    runs = np.convolve(np.append(apart, np.ones(PARTED - 1)), np.ones(PARTED), mode="valid")
    began = apart & (runs > PARTED - 0.5)
    return PERIOD * (first + int(np.argmax(began))) if began.any() else float("nan")


def detected(values: np.ndarray, first: int, last: int, rules: ContactSettings) -> float:
    """Time [s] at which a contact is declared between two samples; NaN where none is."""
    detector = ContactDetector(rules, PERIOD)
    for k in range(first, last):
        if detector.update(float(values[k])) is not None:
            return PERIOD * k
    return float("nan")


class Recoil:
    """The streaming contact detector on one motor, as a `spirob.trials.play.Reaction`.

    motor   whose current is heard;  filtered  through the paper's 100-sample mean
    begins  row from which on it listens;  ends  first row of the recoil, which comes at the latest
            when the schedule has come there by itself
    told    row at which a contact was declared, None where none was
    """

    def __init__(
        self, motor: int, filtered: bool, begins: int, ends: int, rules: ContactSettings
    ) -> None:
        # the mean is a trial's: it has heard what came before, in the log as on the robot
        self.begins = begins - WINDOW if filtered else begins
        self.ends = ends
        self.told: int | None = None
        self._motor, self._first = motor, begins
        self._detector = ContactDetector(rules, PERIOD)
        self._heard: deque[float] = deque(maxlen=WINDOW if filtered else 1)

    def __call__(self, row: int, currents: Sequence[float]) -> int:
        """Listen; the recoil's first row where a contact is declared."""
        self._heard.append(currents[self._motor])
        if row < self._first:
            return row
        level = sum(self._heard) / len(self._heard)
        if self._detector.update(level) is None:
            return row
        self.told = row
        return self.ends


class Repeat:
    """The recoil of another side, at the row at which that one's began; none where none did."""

    def __init__(self, told: int | None, begins: int, ends: int) -> None:
        self.begins, self.ends, self.told = begins, ends, told

    def __call__(self, row: int, currents: Sequence[float]) -> int:
        """The recoil's first row where the other recoiled."""
        return self.ends if row == self.told else row


PAPER_RMSE = 0.307  # A, filtered
AIM_RMSE = 0.1  # A
MODELS = ("base", "named")


def rmse(one: np.ndarray, other: np.ndarray) -> float:
    """Root of the mean squared difference, up to the end of the shorter one."""
    both = min(len(one), len(other))
    return float(np.sqrt(np.mean((one[:both] - other[:both]) ** 2)))


def in_one_motion(
    what: str, played: Mapping[str, Side], signal: str, motor: int, recoils: bool
) -> dict[str, Any]:
    """Row of the RMSE [A] of models that moved as the robot did.

    played   side -> what it did;  signal  `current` or `filtered`
    recoils  whether the trial has a recoil; else the models' own motion is the robot's
    """
    errors = {}
    for model in MODELS:
        side = played.get(repeating(model) if recoils else model)
        if side is not None and "robot" in played:
            errors[model] = _between(side, played["robot"], signal, motor)
    note = "the model moves as the robot did and recoils when it did" if recoils else ""
    return _aimed(what, errors, note, PAPER_RMSE if recoils else None)


def each_in_its_own(
    what: str, robots: Sequence[Side], models: Mapping[str, Side], signal: str, motor: int
) -> dict[str, Any]:
    """Row of the mean RMSE [A] over the robot's plays of one trial; of the robot, over their pairs.

    What two plays of one robot differ by is no model's fault.
    """
    errors = {
        m: _mean([_between(models[m], robot, signal, motor) for robot in robots])
        for m in MODELS
        if m in models and robots
    }
    pairs = [_between(one, other, signal, motor) for one, other in combinations(robots, 2)]
    note = "to the end of the shorter; a recoil at another time counts as error"
    if pairs:
        errors["robot"] = _mean(pairs)
        note = f"{note}; mean over {len(robots)} plays of the robot, its own against each other"
    return _aimed(what, errors, note, None)


def _between(one: Side, other: Side, signal: str, motor: int) -> float:
    return rmse(one.driven(signal, motor), other.driven(signal, motor))


def _mean(errors: Sequence[float]) -> float:
    return float(np.mean(errors))


def _aimed(
    what: str, errors: Mapping[str, float], note: str, paper: float | None
) -> dict[str, Any]:
    met = bool(errors["named"] <= AIM_RMSE) if "named" in errors else None
    return row(what, "A", errors, paper=paper, aim=f"at most {AIM_RMSE} A", met=met, note=note)
