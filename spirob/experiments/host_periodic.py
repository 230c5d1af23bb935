"""Periodic contact with the current loop on the host: the wheel of `periodic_contact`.

The apparent period is told by two rules: the strongest line of the mean spectrum, of a count at
least, and the mean interval between peaks that stand out of what the current does without a
contact.  The arm does not come back alike from hit to hit, so that a few seconds have another line
each time: the spectrum is Welch's mean over `SEGMENT`, half of each shared with the next.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import scipy

from spirob.experiments import Side, Sides, curve, row, within
from spirob.experiments.direct_drive import per_unit, reconstructed
from spirob.experiments.host_loop import GainSet, OnHost, or_none
from spirob.experiments.periodic_contact import (
    BAND,
    PAPER,
    SHOWN,
    SMOOTHING,
    PeriodicContact,
    in_time,
    seen,
)
from spirob.experiments.response import PERIOD, smooth

SEGMENT = 4.0  # s: lines 0.25 Hz apart
HIGHEST = 12.0  # Hz of the spectrum in the report
PARTS = 3  # of a trial, whose lines say how far one of a few seconds is to be trusted
APART = 0.02  # s, least between two peaks
ALIKE = 0.1  # most by which an apparent period of the model may be off
SIGNALS = {
    "current": "current",
    "filtered": "filtered",
    "arm_current": "reconstructed current",
    "displacement": "angle",
}
SPECTRA = {
    "amplitude of the current": "current",
    "amplitude of the reconstructed current": "arm_current",
}
AS_PAPER = ("filtered", "arm_current")


def highest(values: np.ndarray) -> float:
    """By how much the highest peak of a signal rises from its surroundings; 0 without any."""
    _, about = scipy.signal.find_peaks(values, prominence=0.0)
    return float(np.max(about["prominences"], initial=0.0))


def peak_interval(values: np.ndarray, least: float) -> float:
    """Mean interval [s] between peaks of a signal that rise by `least` from their surroundings.

    NaN where there are not two.
    """
    peaks, _ = scipy.signal.find_peaks(values, prominence=least, distance=round(APART / PERIOD))
    return float(np.mean(np.diff(peaks)) * PERIOD) if len(peaks) > 1 else float("nan")


def mean_spectrum(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz] and amplitudes of the lines in Welch's mean spectrum."""
    n = min(len(values), round(SEGMENT / PERIOD))
    frequency, power = scipy.signal.welch(
        values, 1 / PERIOD, nperseg=n, nfft=8 * n, detrend="linear", scaling="spectrum"
    )
    return frequency, np.sqrt(2 * power)


def mean_line(values: np.ndarray, shortest: float, longest: float) -> tuple[float, float]:
    """Period [s] within two bounds and amplitude of the strongest of these lines."""
    frequency, size = mean_spectrum(values)
    band = (frequency >= 1 / longest) & (frequency <= 1 / shortest)
    k = int(np.argmax(size[band]))
    return float(1 / frequency[band][k]), float(size[band][k])


def alike(told: Mapping[str, float]) -> dict[str, Any]:
    """Whether the named model has the robot's period; nothing where one of them has none."""
    met = within(told.get("named"), told.get("robot"), ALIKE)
    return {} if met is None else {"aim": f"within {ALIKE:.0%}", "met": met}


def by_parts(periods: list[float]) -> str:
    """What the parts of a robot's own trial tell, each for itself."""
    return f"robot, third by third: {min(periods):.2f} to {max(periods):.2f} s"


@dataclass(frozen=True, kw_only=True)
class HostPeriodic(OnHost, PeriodicContact):
    """The wheel of PeriodicContact under each set of gains."""

    title: ClassVar[str] = "Periodic contact, no gearbox, current loop on the host"
    about: ClassVar[str] = (
        "The current follows the arm's own swing between hits of the wheel, for a slow loop on the "
        "host lets the back-EMF through. What (12) feeds forward hides it here as well. "
        "Single dynamics has no motor to be pushed: its current stays the commanded one, 0 counts "
        "and no period, while its angle swings."
    )
    named: ClassVar[str] = "host_peg"
    duration: float = 12.5

    def measure(self, sides: Sides) -> list[dict[str, Any]]:
        rows = []
        for one in self.sets:
            # the same rule as with the loop in the drive, on the plays of this set
            own = {self._name(p): self.at(sides, one, p) for p in (None, *self.places)}
            for k, place in enumerate(self.places):
                for signal in SIGNALS:
                    if signal == "arm_current" and not self._modelled(own, place):
                        continue
                    rows += self._told(own, one, k, place, signal)
        return rows

    def _period(self, values: np.ndarray) -> float:
        period, size = mean_line(values, *BAND)
        return period if size >= 1.0 else float("nan")

    def _told(
        self, own: Sides, one: GainSet, k: int, place: float, signal: str
    ) -> list[dict[str, Any]]:
        periods, sizes, lines = self._lines(own, place, signal)
        hits, free = own[self._name(place)], own[self._name(None)]
        gaps = {s: self._gaps(hits[s], free[s], signal)[0] for s in periods}
        shown = or_none(periods)
        hidden = [s for s, period in shown.items() if period != "none" and np.isnan(period)]
        notes = [f"not visible, no line of one count: {', '.join(hidden)}"] if hidden else []
        apart = ""
        if signal == "current" and "robot" in hits and "robot" not in hidden:
            robot = hits["robot"], free["robot"], signal
            parts = np.array_split(seen(*robot, self.begins), PARTS)
            notes.append(by_parts([mean_line(part, *BAND)[0] for part in parts]))
            apart = by_parts(self._gaps(*robot, PARTS))
        at = f"{SIGNALS[signal]}, {one.words}, at {place:.0%}"
        as_paper = signal in AS_PAPER and len(self.places) == len(PAPER)
        paper, note = PAPER[k] if as_paper else None, "; ".join(notes)
        tip = k == len(self.places) - 1 and signal == "current"
        aims = [alike(told) if tip else {} for told in (periods, gaps)]
        return [
            row(f"apparent period of {at}", "s", shown, paper=paper, note=note, **aims[0]),
            row(f"interval between peaks of {at}", "s", or_none(gaps), note=apart, **aims[1]),
            row(f"swing of {at}", "counts", sizes),
            row(f"line at 1/T of {at}", "counts", lines),
        ]

    def _modelled(self, own: Sides, place: float) -> bool:
        """Whether a side has an i**."""
        return any(side.arm_current is not None for side in own[self._name(place)].values())

    def _gaps(self, hit: Side, free: Side, signal: str, parts: int = 1) -> list[float]:
        """The interval between peaks in each part of a trial [s]."""
        values = smooth(seen(hit, free, signal, self.begins), SMOOTHING)
        alone = smooth(per_unit(signal) * free.driven(signal, self.motor), SMOOTHING)
        noise = highest(alone[round(1e3 * self.begins) :]) * np.sqrt(2)  # of a difference
        return [peak_interval(p, max(1.0, noise)) for p in np.array_split(values, parts)]

    def curves(self, sides: Sides) -> list[dict[str, Any]]:
        out = []
        one = self.slowest
        free = self.at(sides, one, None)
        for place in self.places:
            for s, hit in self.at(sides, one, place).items():
                play = f"{one.words}, at {place:.0%}"
                angle = seen(hit, free[s], "displacement", self.begins)[:SHOWN]
                time = np.arange(len(angle)) * PERIOD
                out.append(curve(play, "angle", "counts", s, time, angle, 10))
                out += in_time(play, s, hit, free[s], self.begins)
                for quantity, signal in SPECTRA.items():
                    name = reconstructed(hit) if signal == "arm_current" else signal
                    frequency, size = mean_spectrum(seen(hit, free[s], name, self.begins))
                    low = (frequency > 0.0) & (frequency <= HIGHEST)
                    lines = frequency[low], size[low]
                    out.append(curve(play, quantity, "counts", s, *lines, 2))
        return out
