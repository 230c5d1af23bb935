"""Periodic contact: a peg on a turning wheel strikes the arm every T = 0.1 s.

Both motors hold the same constant current without a gearbox.  The apparent period is that of the
strongest line of what the motor reports; the paper's 100-sample mean has a null at exactly 10 Hz,
so the true period cannot be seen behind it, and what is seen instead is something else.  A line of
less than one count is none that the drive could show: the sensor's noise has a strongest one, too.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from spirob.experiments import WINDOW, Experiment, Play, Side, Sides, curve, row, trial
from spirob.experiments.passive import both, difference, direct, reconstructed
from spirob.experiments.response import PERIOD, amplitude, smooth, strongest_period
from spirob.logs.trace import moving_average
from spirob.trials.trial import beside

PAPER = (0.4, 0.35, 0.15)  # s, from base to tip
SMOOTHING, SHOWN = 11, 4000  # samples, of the current in the report
BAND = (0.02, 1.5)  # s, shortest and longest period that counts
SIGNALS = ("displacement", "displacement, mean", "current", "filtered")


def seen(hit: Side, free: Side, signal: str, begins: float) -> np.ndarray:
    """What the contact adds to a signal from `begins` [s] on, in counts.

    "displacement, mean" is the angle after the same 100-sample mean as "filtered" current.
    """
    name, mean, _ = signal.partition(", mean")
    values = difference(hit, free, name)
    return (moving_average(values, WINDOW) if mean else values)[round(1e3 * begins) :]


def in_time(play: str, s: str, hit: Side, free: Side, begins: float) -> list[dict[str, Any]]:
    """Figure of the measured current, and of i** beside it; the robot's is measured in both."""
    out = []
    for quantity, signal in (("current", "current"), ("reconstructed", reconstructed(hit))):
        values = smooth(seen(hit, free, signal, begins), SMOOTHING)[:SHOWN]
        out.append(curve(play, quantity, "counts", s, np.arange(len(values)) * PERIOD, values, 10))
    return out


@dataclass(frozen=True, kw_only=True)
class PeriodicContact(Experiment):
    """places     along the straight arm, as shares of its length, from the base
    depth      by which the peg would enter the straight arm [m]
    diameter   of the peg, radius of its circle [m];  period [s]
    current    of both motors [A];  bandwidth of the drive's current loop [Hz]
    begins     what comes before is left out [s];  duration [s]
    """

    title: ClassVar[str] = "Periodic contact, no gearbox, constant current"
    about: ClassVar[str] = (
        "The drive's own current loop has answered a hit before the hit is reported, so that the "
        "hits stand in the angle alone. With the loop on the host, as in the paper, the current "
        "shows them."
    )
    places: tuple[float, ...] = (0.25, 0.55, 0.85)
    depth: float = 0.003
    diameter: float = 0.01
    radius: float = 0.005
    period: float = 0.1
    current: float = 0.8
    bandwidth: float = 1000.0
    begins: float = 0.5
    duration: float = 4.5

    def plays(self) -> list[Play]:
        rig = direct(self.bandwidth)
        names = [(self._name(place), place) for place in (None, *self.places)]
        return [Play(name, self.trial_at(name, place), rig) for name, place in names]

    def _name(self, place: float | None) -> str:
        return f"peg_{'free' if place is None else f'{100 * place:.0f}'}"

    def trial_at(self, name: str, place: float | None) -> dict[str, Any]:
        """A trial with a contact at a place, or without any, as plain data."""
        scene = None
        if place is not None:
            x = place * self.geometry.length
            off = self.diameter / 2 + self.radius - self.depth
            about = {"diameter": self.diameter, "radius": self.radius, "period": self.period}
            y = beside(self.geometry.arm(), x, off)
            scene = {"peg": {**about, "x": float(x), "y": float(y), "phase": float(np.pi / 2)}}
        return trial(name, self.duration, **both(self.current), scene=scene)

    def measure(self, sides: Sides) -> list[dict[str, Any]]:
        rows = []
        for k, place in enumerate(self.places):
            for signal in SIGNALS:
                periods, sizes, lines = self._lines(sides, place, signal)
                filtered = signal in ("filtered", "displacement, mean")
                paper = PAPER[k] if signal == "filtered" and len(self.places) == 3 else None
                hidden = [s for s, period in periods.items() if np.isnan(period)]
                notes = ["10 Hz is a null of the mean"] if filtered else []
                if hidden:
                    notes.append(f"not visible, no line of one count: {', '.join(hidden)}")
                note = "; ".join(notes)
                at = f"{signal}, at {place:.0%}"
                rows.append(row(f"apparent period of {at}", "s", periods, paper=paper, note=note))
                rows.append(row(f"swing of {at}", "counts", sizes))
                rows.append(row(f"line at 1/T of {at}", "counts", lines))
        return rows

    def _period(self, values: np.ndarray) -> float:
        """Of the strongest line, where it has a count [s]; NaN where it has not."""
        period = strongest_period(values, *BAND)
        shown = np.isfinite(period) and amplitude(values, period) >= 1.0
        return period if shown else float("nan")

    def _lines(self, sides: Sides, place: float, signal: str) -> tuple[dict, dict, dict]:
        """Side -> strongest period, standard deviation times √2, amplitude at the true period."""
        periods, sizes, lines = {}, {}, {}
        free = sides[self._name(None)]
        for s, hit in sides[self._name(place)].items():
            name = signal.partition(", ")[0]
            if getattr(hit, "current" if name == "filtered" else name) is None:
                continue
            values = seen(hit, free[s], signal, self.begins)
            time = np.arange(len(values))
            level = values - np.polyval(np.polyfit(time, values, 1), time)
            sizes[s] = float(np.sqrt(2) * level.std())
            periods[s] = self._period(values)
            lines[s] = amplitude(values, self.period)
        return periods, sizes, lines

    def curves(self, sides: Sides) -> list[dict[str, Any]]:
        out = []
        free = sides[self._name(None)]
        for place in self.places:
            for s, hit in sides[self._name(place)].items():
                values = seen(hit, free[s], "displacement", self.begins)
                time = np.arange(len(values)) * 1e-3
                play = f"at {place:.0%}"
                out.append(curve(play, "angle", "counts", s, time, values, 10))
                if hit.current is not None:
                    out += in_time(play, s, hit, free[s], self.begins)
        return out
