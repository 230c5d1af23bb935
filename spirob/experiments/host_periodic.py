"""Periodic contact with the current loop on the host: the wheel of `periodic_contact`.

The apparent period is told by the two rules of `passive`, the same for robot and models:
the strongest line of the mean spectrum, of a count at least, and the mean interval between peaks
that stand out of what the robot's current does without a contact.  A period does not depend on how
high a peak has to be: the robot has none by the interval where it is another, by more than `ALIKE`,
between peaks twice as high.  Taken off is the mean of the plays without the wheel.

How often a trial is played follows from its own standard error.  Where the current shows, every
noisy side plays each trial `least` times.  Then the robot's and the named model's plays at a place
are doubled until each rule has settled whether the model's period is off by more than `ALIKE`, or
`most` are played.  Nothing is settled by a robot whose own period is not sure to `ALIKE`.

Where the model's line is then off, or open, `builds` of it are played, which differ by what no
trial tells of a build (`identify.builds`).  Where their lines are apart by more than `ALIKE`, by
two standard deviations, a model can have the robot's by knowing its build alone.  So a comparison
is met, missed, "not settled", "a matter of the build", or the robot has "no period".
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count, takewhile
from typing import Any, ClassVar

import numpy as np
import scipy

from spirob.errors import ConfigError
from spirob.experiments import BUILT, Play, Side, Sides, curve, row
from spirob.experiments.host_loop import COMPARED, NOISY, GainSet, OnHost, or_none
from spirob.experiments.passive import (
    BEYOND,
    OPEN,
    SURE,
    WITHIN,
    Figure,
    compared,
    highest,
    interval,
    line,
    mean_spectrum,
    off,
    per_unit,
    percent,
    reconstructed,
)
from spirob.experiments.periodic_contact import (
    BAND,
    PAPER,
    SHOWN,
    SMOOTHING,
    PeriodicContact,
    in_time,
    seen,
)
from spirob.experiments.response import PERIOD, amplitude, smooth

HIGHEST = 12.0  # Hz of the spectrum in the report
ALIKE = 0.1  # most by which a model's apparent period may be off
LEAST = 1.0  # count, of a line or a peak that shows
NO_PERIOD, NOT_VISIBLE, BUILD = "no period", "not visible", "a matter of the build"
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
MET = {WITHIN: True, BEYOND: False}
HIGHER = 2.0  # times as high: 6 dB
NONE = Figure(float("nan"), float("nan"))
Verdict = dict[str, Any]  # aim, met and note of a row; empty where there is nothing to judge
Told = Mapping[str, Sequence[np.ndarray]]  # side -> what the wheel adds to a signal in each play


def steady(interval: Figure, higher: Figure) -> bool:
    """Whether an interval is about that between peaks `HIGHER` times as high."""
    return bool(abs(higher.value / interval.value - 1.0) <= ALIKE)


def judged(periods: Mapping[str, Figure], plays: int, why: str = "") -> Verdict:
    """Whether the named model has the robot's period.

    periods  side -> its period [s];  plays  of the robot;  why  it has none, where it has none
    Nothing where one of the two has not played, or the robot once.
    """
    if plays < 2 or not {"robot", "named"} <= set(periods):
        return {}
    robot, named = periods["robot"], periods["named"]
    aim = f"within {ALIKE:.0%}"
    if not np.isfinite(robot.value):
        return {"aim": aim, "met": NO_PERIOD, "note": f"{NO_PERIOD} of the robot's{why}"}
    if not np.isfinite(named.value):
        return {"aim": aim, "met": False, "note": f"{NO_PERIOD} of the model's"}
    said, why = compared(named, robot, ALIKE), OPEN
    if SURE * robot.error > ALIKE * robot.value:
        said, why = OPEN, f"{OPEN}, the robot's own is not sure to {ALIKE:.0%}"
    note = (
        f"{plays} plays each, standard error {robot.error:.3f} s of the robot's and "
        f"{named.error:.3f} s of the model's: {percent(off(named, robot))} off"
    )
    note = f"{note}; {why}" if said == OPEN else note
    return {"aim": aim, "met": MET.get(said, said), "note": note}


def beside_builds(said: Verdict, periods: Sequence[float]) -> Verdict:
    """A verdict on the named model, beside the periods [s] that two builds of it and more have."""
    if len(periods) < 2:
        return said
    low, high = min(periods), max(periods)
    apart = SURE * np.std(periods, ddof=1) > ALIKE * np.mean(periods)
    note = f"{said['note']}; {len(periods)} builds of the model have {low:.2f} to {high:.2f} s"
    return said | {"note": note} | ({"met": BUILD} if apart else {})


@dataclass(frozen=True, kw_only=True)
class HostPeriodic(OnHost, PeriodicContact):
    """The wheel of PeriodicContact under each set of gains.

    least, most  plays of each trial in which the current shows
    builds       of the named model, each with `least` plays, where its period is not the robot's
    """

    title: ClassVar[str] = "Periodic contact, no gearbox, current loop on the host"
    about: ClassVar[str] = (
        "The current follows the arm's own swing between hits of the wheel, for a slow loop on the "
        "host lets the back-EMF through. What (12) feeds forward hides it here as well. "
        "Single dynamics has no motor to be pushed: its current stays the commanded one, 0 counts "
        "and no period, while its angle swings. Periods and spectra are of all plays of a side; "
        "what is drawn over time is the first."
    )
    named: ClassVar[str] = "host_peg"
    duration: float = 12.5
    least: int = 8
    most: int = 16
    builds: int = 0

    def __post_init__(self) -> None:
        if not 2 <= self.least <= self.most:
            raise ConfigError(
                f"paper.host_periodic.least = {self.least}, most = {self.most}: two plays at "
                "least, and at most no fewer"
            )

    def more(self, sides: Sides) -> list[Play]:
        shown = [one for one in self.sets if self._shows(sides, one)]
        return [p for one in shown for p in self._more(sides, one) or self._anew(sides, one)]

    def _more(self, sides: Sides, one: GainSet) -> list[Play]:
        """Of every side to `least`, then as many again of what is open."""
        trials = (None, *self.places)
        have = {place: len(self._plays(sides, one, place)["robot"]) for place in trials}
        wanted = {place: self.least for place in trials if have[place] < self.least}
        only = NOISY if wanted else COMPARED
        if not wanted:
            wanted = {p: min(2 * have[p], self.most) for p in self._open(sides, one)}
        return [
            replace(self.play(self.play_of(one, place, k), place, one), only=only)
            for place, plays in wanted.items()
            for k in range(have[place], plays)
        ]

    def _anew(self, sides: Sides, one: GainSet) -> list[Play]:
        """Of builds, at the places where the named model's line is not the robot's."""
        off = [p for p in self.places if self._line(sides, one, p).get("met") in (False, OPEN)]
        found = [
            replace(self.play(name, place, one), only=(BUILT,), built=build)
            for build in range(self.builds if off else 0)
            for place in (None, *off)
            for name in self._names(one, place, build)
        ]
        return [play for play in found if play.name not in sides]

    def _names(self, one: GainSet, place: float | None, build: int) -> list[str]:
        """Of the plays of a build."""
        return [f"{self.play_of(one, place, k)}_build{build}" for k in range(self.least)]

    def _of_builds(self, sides: Sides, one: GainSet, place: float) -> list[float]:
        """Periods [s] of the builds that have played and show one."""
        told = {}
        for build in range(self.builds):
            names, without = (self._names(one, p, build) for p in (place, None))
            hits = [sides[name][BUILT] for name in names if name in sides]
            if hits:
                free = Side.mean([sides[name][BUILT] for name in without])
                told[str(build)] = [seen(hit, free, "current", self.begins) for hit in hits]
        periods = [period.value for period in self._periods(told).values()]
        return [period for period in periods if np.isfinite(period)]

    def _line(self, sides: Sides, one: GainSet, place: float) -> Verdict:
        """What the strongest line says of the named model, builds aside."""
        told = self._seen(sides, one, place, "current")
        return judged(self._periods(told), len(told.get("robot", ())))

    def _plays(self, sides: Sides, one: GainSet, place: float | None) -> dict[str, list[Side]]:
        """Side -> its plays of one trial, in their order."""
        names = ((k, self.play_of(one, place, k)) for k in count())
        known = [k for k, _ in takewhile(lambda found: found[1] in sides, names)]
        plays = [self.at(sides, one, place, k) for k in known]
        return {s: [play[s] for play in plays if s in play] for s in plays[0]}

    def _free(self, sides: Sides, one: GainSet) -> dict[str, Side]:
        """Side -> mean of its plays without the wheel."""
        return {s: Side.mean(plays) for s, plays in self._plays(sides, one, None).items()}

    def _seen(self, sides: Sides, one: GainSet, place: float, signal: str) -> Told:
        """What the wheel adds to a signal [counts], of all sides that have it."""
        name, free = "current" if signal == "filtered" else signal, self._free(sides, one)
        return {
            s: [seen(hit, free[s], signal, self.begins) for hit in plays]
            for s, plays in self._plays(sides, one, place).items()
            if getattr(plays[0], name) is not None
        }

    def _shows(self, sides: Sides, one: GainSet) -> bool:
        """Whether the robot's current has a line of a count anywhere."""
        told = [self._seen(sides, one, p, "current").get("robot") for p in self.places]
        return any(signals is not None and line(signals, *BAND)[1] >= LEAST for signals in told)

    def _periods(self, told: Told) -> dict[str, Figure]:
        """Side -> period of its strongest line, where it has a count."""
        found = {s: line(signals, *BAND) for s, signals in told.items()}
        return {s: period if size >= LEAST else NONE for s, (period, size) in found.items()}

    def _height(self, free: Side, signal: str) -> float:
        """Of a peak that noise makes of a difference to the mean without the wheel [counts]."""
        first = round(1e3 * self.begins)
        alone = [per_unit(signal) * one.driven(signal, self.motor) for one in free.parts]
        peaks = [highest(smooth(one, SMOOTHING)[first:]) for one in alone]
        return float(max(LEAST, np.mean(peaks) * np.sqrt(1 + 1 / len(peaks))))

    def _intervals(
        self, told: Told, free: Mapping[str, Side], signal: str, times: float = 1.0
    ) -> dict[str, Figure]:
        """Side -> interval between peaks so many times as high as the robot's noise.

        As high as its own where the robot has no such signal.
        """
        found = {}
        for s, each in told.items():
            height = self._height(free["robot" if "robot" in told else s], signal)
            found[s] = interval([smooth(one, SMOOTHING) for one in each], times * height)
        return found

    def _judged(
        self, told: Told, free: Mapping[str, Side]
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """What the line and the interval of a current say of the named model."""
        if "robot" not in told:
            return {}, {}
        plays = len(told["robot"])
        once, twice = (self._intervals(told, free, "current", k) for k in (1.0, HIGHER))
        height, robots = self._height(free["robot"], "current"), (once["robot"], twice["robot"])
        values = [f"{each.value:.2f} s" for each in robots]
        why = f": {values[0]} between peaks of {height:.1f} counts, {values[1]} of twice that"
        gaps = once if steady(*robots) else once | {"robot": NONE}
        return judged(self._periods(told), plays), judged(gaps, plays, why)

    def _open(self, sides: Sides, one: GainSet) -> list[float]:
        """Places at which a rule has not settled how far the named model is off."""
        free, places = self._free(sides, one), []
        for place in self.places:
            told = self._seen(sides, one, place, "current")
            said = [rule.get("met") for rule in self._judged(told, free)]
            places += [place] * (OPEN in said and len(told["robot"]) < self.most)
        return places

    def measure(self, sides: Sides) -> list[dict[str, Any]]:
        rows = []
        for one in self.sets:
            rows.append(self._visible(sides, one))
            for k, place in enumerate(self.places):
                for signal in SIGNALS:
                    rows += self._told(sides, one, k, place, signal)
        return rows

    def _visible(self, sides: Sides, one: GainSet) -> dict[str, Any]:
        """Row of the strongest line nearest to the tip."""
        tip = self.places[-1]
        told = self._seen(sides, one, tip, "current")
        sizes = {s: line(signals, *BAND)[1] for s, signals in told.items()}
        met = None if "robot" not in sizes else sizes["robot"] >= LEAST or NOT_VISIBLE
        what = f"strongest line of current, {one.words}, at {tip:.0%}"
        return row(what, "counts", sizes, aim=f"at least {LEAST:g} count", met=met)

    def _told(
        self, sides: Sides, one: GainSet, k: int, place: float, signal: str
    ) -> list[dict[str, Any]]:
        told, free = self._seen(sides, one, place, signal), self._free(sides, one)
        if signal == "arm_current" and not set(told) - {"single"}:
            return []  # no model has played
        periods, gaps = self._periods(told), self._intervals(told, free, signal)
        shown, intervals = (
            or_none({s: each.value for s, each in of.items()}) for of in (periods, gaps)
        )
        hidden = [s for s, period in shown.items() if period != "none" and np.isnan(period)]
        note = f"not visible, no line of one count: {', '.join(hidden)}" if hidden else ""
        at = f"{SIGNALS[signal]}, {one.words}, at {place:.0%}"
        as_paper = signal in AS_PAPER and len(self.places) == len(PAPER)
        beside = as_paper and len(hidden) < len(periods.keys() - {"single"})
        about = {"paper": PAPER[k] if beside else None, "note": note}
        strongest, mean = self._judged(told, free) if signal == "current" else ({}, {})
        if strongest and strongest["met"] is not True:
            strongest = beside_builds(strongest, self._of_builds(sides, one, place))
        swings = {s: float(np.mean([_swing(v) for v in each])) for s, each in told.items()}
        lines = {
            s: float(np.mean([amplitude(v, self.period) for v in each])) for s, each in told.items()
        }
        return [
            row(f"apparent period of {at}", "s", shown, **about | strongest),
            row(f"interval between peaks of {at}", "s", intervals, **mean),
            row(f"swing of {at}", "counts", swings),
            row(f"line at 1/T of {at}", "counts", lines),
        ]

    def curves(self, sides: Sides) -> list[dict[str, Any]]:
        out = []
        one = self.slowest
        free = self._free(sides, one)
        for place in self.places:
            play = f"{one.words}, at {place:.0%}"
            for s, hits in self._plays(sides, one, place).items():
                hit = hits[0]
                angle = seen(hit, free[s], "displacement", self.begins)[:SHOWN]
                time = np.arange(len(angle)) * PERIOD
                out.append(curve(play, "angle", "counts", s, time, angle, 10))
                out += in_time(play, s, hit, free[s], self.begins)
                for quantity, signal in SPECTRA.items():
                    name = reconstructed(hit) if signal == "arm_current" else signal
                    each = [seen(hit, free[s], name, self.begins) for hit in hits]
                    out.append(_spectrum(play, quantity, s, each))
        return out


def _swing(values: np.ndarray) -> float:
    """√2 times the deviation from a straight line."""
    return float(np.sqrt(2) * scipy.signal.detrend(values).std())


def _spectrum(play: str, quantity: str, side: str, signals: Sequence[np.ndarray]) -> dict[str, Any]:
    """Figure of the mean spectrum of all plays."""
    frequency, size = mean_spectrum(signals)
    low = (frequency > 0.0) & (frequency <= HIGHEST)
    return curve(play, quantity, "counts", side, frequency[low], size[low], 2)
