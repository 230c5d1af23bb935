"""Periodic contact with the current loop on the host: the wheel of `periodic_contact`.

The apparent period is told by two rules: the strongest line of the mean spectrum, of a count at
least, and the mean interval between peaks that stand out of what the current does without a
contact.  The arm does not come back alike from hit to hit, so that a few seconds have another line
each time: the spectrum is Welch's mean over `SEGMENT`, half of each shared with the next.

A rule judges a model where the robot repeats itself by it: where the current shows, every noisy
side plays each trial `again`, and the robot's plays are asked for no more than a model is, to lie
within `ALIKE`.  Figures of both rules are means over the plays.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, ClassVar

import numpy as np
import scipy

from spirob.experiments import Play, Side, Sides, curve, row, within
from spirob.experiments.direct_drive import per_unit, reconstructed
from spirob.experiments.host_loop import NOISY, GainSet, OnHost, or_none
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
APART = 0.02  # s, least between two peaks
ALIKE = 0.1  # most by which an apparent period may be off: a model's, and the robot's own again
LEAST = 1.0  # count, of a line or a peak that shows
NOT_REPEATED, NOT_VISIBLE = "not repeated", "not visible"
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
AGAIN = "robot again"  # side in a figure


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


def apart(periods: Sequence[float]) -> float:
    """From the shortest to the longest period of several plays, over their mean; NaN of one."""
    if len(periods) < 2:
        return float("nan")
    return float(np.ptp(periods) / np.mean(periods))


def by_side(plays: Sequence[Mapping[str, float]]) -> dict[str, list[float]]:
    """Side -> its figure in each play."""
    return {s: [play[s] for play in plays if s in play] for s in plays[0]}


def mean(plays: Mapping[str, Sequence[float]]) -> dict[str, float]:
    """Side -> mean of its plays; NaN where one has none."""
    return {s: float(np.mean(each)) for s, each in plays.items()}


def judged(plays: Mapping[str, Sequence[float]]) -> dict[str, Any]:
    """Whether the named model has the robot's period, by a rule by which the robot repeats itself.

    plays  side -> its period in each play [s]
    Nothing where one of the two has no period, or the robot has played once.
    """
    told = mean(plays)
    met: bool | str | None = within(told.get("named"), told.get("robot"), ALIKE)
    own = apart(plays.get("robot", ()))
    if met is None or np.isnan(own):
        return {}
    each = ", ".join(f"{one:.2f}" for one in plays["robot"])
    note = f"the robot's own plays: {each} s, {own:.0%} apart"
    if own > ALIKE:
        met, note = NOT_REPEATED, f"{note}: not repeated by the robot itself, so judges no model"
    return {"aim": f"within {ALIKE:.0%}", "met": met, "note": note}


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
    again: int = 1

    def more(self, sides: Sides) -> list[Play]:
        plays = []
        for one in self.sets:
            if not self._shows(self._played(sides, one)[0]):
                continue
            for place, k in product((None, *self.places), range(1, self.again + 1)):
                name = self.play_of(one, place, k)
                if name not in sides:
                    plays.append(replace(self.play(name, place, one), only=NOISY))
        return plays

    def _played(self, sides: Sides, one: GainSet) -> list[Sides]:
        """Each play under one set, named as with the loop in the drive, whose rules it goes by."""
        return [
            {self._name(place): self.at(sides, one, place, k) for place in (None, *self.places)}
            for k in range(self.again + 1)
            if self.play_of(one, None, k) in sides
        ]

    def _shows(self, own: Sides) -> bool:
        """Whether the robot's current has a line of a count anywhere."""
        told = [self._lines(own, place, "current")[0].get("robot") for place in self.places]
        return any(period is not None and np.isfinite(period) for period in told)

    def measure(self, sides: Sides) -> list[dict[str, Any]]:
        rows = []
        for one in self.sets:
            played = self._played(sides, one)
            rows.append(self._visible(played[0], one))
            for k, place in enumerate(self.places):
                for signal in SIGNALS:
                    if signal == "arm_current" and not self._modelled(played[0], place):
                        continue
                    rows += self._told(played, one, k, place, signal)
        return rows

    def _visible(self, own: Sides, one: GainSet) -> dict[str, Any]:
        """Row of the strongest line nearest to the tip."""
        tip = self.places[-1]
        hits, free = own[self._name(tip)], own[self._name(None)]
        sizes = {
            s: mean_line(seen(hit, free[s], "current", self.begins), *BAND)[1]
            for s, hit in hits.items()
        }
        met = None if "robot" not in sizes else sizes["robot"] >= LEAST or NOT_VISIBLE
        what = f"strongest line of current, {one.words}, at {tip:.0%}"
        return row(what, "counts", sizes, aim=f"at least {LEAST:g} count", met=met)

    def _period(self, values: np.ndarray) -> float:
        period, size = mean_line(values, *BAND)
        return period if size >= LEAST else float("nan")

    def _told(
        self, played: list[Sides], one: GainSet, k: int, place: float, signal: str
    ) -> list[dict[str, Any]]:
        _, sizes, lines = self._lines(played[0], place, signal)
        periods = by_side([self._lines(own, place, signal)[0] for own in played])
        gaps = by_side([self._gaps(own, place, signal) for own in played])
        shown, intervals = (or_none(mean(plays)) for plays in (periods, gaps))
        hidden = [s for s, period in shown.items() if period != "none" and np.isnan(period)]
        note = f"not visible, no line of one count: {', '.join(hidden)}" if hidden else ""
        at = f"{SIGNALS[signal]}, {one.words}, at {place:.0%}"
        as_paper = signal in AS_PAPER and len(self.places) == len(PAPER)
        compared = as_paper and len(hidden) < len(periods.keys() - {"single"})
        paper = PAPER[k] if compared else None
        line, gap = (judged(plays) if signal == "current" else {} for plays in (periods, gaps))
        return [
            row(f"apparent period of {at}", "s", shown, **{"paper": paper, "note": note, **line}),
            row(f"interval between peaks of {at}", "s", intervals, **gap),
            row(f"swing of {at}", "counts", sizes),
            row(f"line at 1/T of {at}", "counts", lines),
        ]

    def _modelled(self, own: Sides, place: float) -> bool:
        """Whether a side has an i**."""
        return any(side.arm_current is not None for side in own[self._name(place)].values())

    def _gaps(self, own: Sides, place: float, signal: str) -> dict[str, float]:
        """The interval between peaks [s] of each side that has the signal."""
        name = "current" if signal == "filtered" else signal
        free = own[self._name(None)]
        return {
            s: self._gap(hit, free[s], signal)
            for s, hit in own[self._name(place)].items()
            if getattr(hit, name) is not None
        }

    def _gap(self, hit: Side, free: Side, signal: str) -> float:
        values = smooth(seen(hit, free, signal, self.begins), SMOOTHING)
        alone = smooth(per_unit(signal) * free.driven(signal, self.motor), SMOOTHING)
        noise = highest(alone[round(1e3 * self.begins) :]) * np.sqrt(2)  # of a difference
        return peak_interval(values, max(LEAST, noise))

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
                    out.append(self._spectrum(play, quantity, s, hit, free[s], name))
            for own in self._played(sides, one)[1:]:
                hit, alone = (own[self._name(p)]["robot"] for p in (place, None))
                about = play, "amplitude of the current", AGAIN
                out.append(self._spectrum(*about, hit, alone, "current"))
        return out

    def _spectrum(
        self, play: str, quantity: str, side: str, hit: Side, free: Side, signal: str
    ) -> dict[str, Any]:
        """Figure of the mean spectrum of a signal."""
        frequency, size = mean_spectrum(seen(hit, free, signal, self.begins))
        low = (frequency > 0.0) & (frequency <= HIGHEST)
        return curve(play, quantity, "counts", side, frequency[low], size[low], 2)
