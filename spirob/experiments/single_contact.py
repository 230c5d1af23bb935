"""Single contact: a spring gun shoots a ball at one place after the other along the arm.

    v = √(k_s/m) Δx        all of the spring's energy goes into the ball (paper)

Both motors hold the same constant current without a gearbox.  What the drive reports is read in
its own counts: the steady shift of the current, its peak, that of the paper's 100-sample mean of
it, and the peak of the angle; beside them stands the arm's profile, which explains them.  A drive
that holds its current hides a contact there, so it is played at several bandwidths; the model plays
also a drive without feed-forward of the back-EMF, which the emulated one does not offer.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import scipy

from spirob.experiments import Experiment, Play, Side, Sides, curve, row, trial
from spirob.experiments.passive import both, difference, direct, profile, reconstructed
from spirob.experiments.response import smooth
from spirob.trials.trial import beside

SHIFT = (0.3, 0.6)  # s after the hit: the paper's steady shift
PEAK = 0.3  # s after the hit
SMOOTHING = 11  # samples
BEFORE = 50  # samples before the hit that a figure shows
READ = (  # key of a response -> what it is called
    ("angle", "angle"),
    ("peak", "current peak"),
    ("filtered", "filtered current peak"),
    ("shift", "shift"),
)
FIGURES = (("peak", "current peak"), ("arm peak", "reconstructed current peak"))
PROFILE = (("stiffness", "N·m/rad"), ("inertia", "kg·m²"), ("give", "m/N"))


def responses(hit: Side, free: Side, at: float) -> dict[str, float]:
    """What one hit at a time [s] does to the left motor, in counts.

    angle   largest change within `PEAK`
    peak    largest change of the current within `PEAK`, over `SMOOTHING` samples
    filtered  largest change within `PEAK` of the current after the paper's 100-sample mean
    shift   mean change of the current within `SHIFT`
    arm peak  largest change of i** within `PEAK`, over `SMOOTHING` samples
    ... error   what noise alone makes of each
    peak noise  standard deviation before the hit of what the peak is read from
    A side without a motor has an angle only.
    """
    first = round(1e3 * at)
    soon = slice(first, first + round(1e3 * PEAK))
    angle = difference(hit, free, "displacement")
    found = {"angle": float(np.abs(angle[soon] - angle[first - 1]).max()), "angle error": 0.0}
    if hit.current is None:
        return found
    current = difference(hit, free, "current")
    steady = current[first + round(1e3 * SHIFT[0]) : first + round(1e3 * SHIFT[1])]
    level, mean = smooth(current, SMOOTHING), difference(hit, free, "filtered")
    whole = smooth(difference(hit, free, reconstructed(hit)), SMOOTHING)
    calm = slice(100, first - SMOOTHING)
    return found | {
        "peak": float(np.abs(level[soon]).max()),
        "peak error": float(1.5 * np.abs(level[calm]).max()),
        "peak noise": float(level[calm].std()),
        "filtered": float(np.abs(mean[soon]).max()),
        "filtered error": float(1.5 * np.abs(mean[calm]).max()),
        "shift": float(steady.mean()),
        "arm peak": float(np.abs(whole[soon]).max()),
        "shift error": float(3 * steady.std() / np.sqrt(len(steady))),
    }


def in_time(
    play: str, hit: Mapping[str, Side], free: Mapping[str, Side], at: float, motor: int
) -> list[dict[str, Any]]:
    """Figure of the measured current about a hit at a time [s], and of i** beside it.

    The robot, which has no i**, shows its measured current in both.
    """
    first, out = round(1e3 * at), []
    span = slice(first - BEFORE, first + round(1e3 * PEAK))
    time = 1e-3 * np.arange(-BEFORE, span.stop - first)
    for s, one in hit.items():
        if one.current is None:
            continue
        named = {"current after a hit": "current", "reconstructed current": reconstructed(one)}
        for quantity, signal in named.items():
            values = smooth(difference(one, free[s], signal, motor), SMOOTHING)[span]
            out.append(curve(play, quantity, "counts", s, time, values, 3))
    return out


def visible(value: float, error: float = 0.0) -> bool:
    """Whether a drive's report can show it: at least one count, and more than noise alone makes."""
    return abs(value) >= 1.0 and abs(value) > error


def rank_agreement(one: list[float], other: list[float]) -> float:
    """Spearman's ρ of two rows of responses; NaN where one of them does not vary."""
    if np.ptp(one) == 0 or np.ptp(other) == 0:
        return float("nan")
    return float(scipy.stats.spearmanr(one, other).statistic)


@dataclass(frozen=True, kw_only=True)
class SingleContact(Experiment):
    """places        along the straight arm, as shares of its length, from the base
    bandwidths    of the drive's current loop [Hz]
    current       of both motors [A]
    spring [N/m], compression [m], mass [kg] and diameter [m]  of gun and ball
    hit           when the ball meets the straight arm [s];  duration [s]
    """

    title: ClassVar[str] = "Single contact, no gearbox, constant current"
    about: ClassVar[str] = (
        "The drive closes its current loop itself, 20 times a cycle of the bus, with an integral "
        "and the back-EMF fed forward, so that it has answered a push before the push is reported. "
        "With the loop on the host, as in the paper, the same push shows."
    )
    places: tuple[float, ...] = (0.2, 0.35, 0.5, 0.65, 0.8, 0.95)
    bandwidths: tuple[float, ...] = (50.0, 200.0, 1000.0)
    current: float = 0.8
    spring: float = 200.0
    compression: float = 0.01
    mass: float = 0.005
    diameter: float = 0.016
    hit: float = 0.5
    duration: float = 1.2

    @property
    def speed(self) -> float:
        """Of the ball [m/s]."""
        return float(np.sqrt(self.spring / self.mass) * self.compression)

    def plays(self) -> list[Play]:
        out = []
        for bandwidth in self.bandwidths:
            rig = direct(bandwidth)
            for place in (None, *self.places):
                name = self._name(bandwidth, place)
                out.append(Play(name, self.trial_at(name, place), rig))
        rig = direct(self.bandwidths[0], emf_compensation=0.0)
        for place in (None, *self.places):
            name = self._name(0.0, place)
            out.append(Play(name, self.trial_at(name, place), rig, only=("base", "named")))
        return out

    def _name(self, bandwidth: float, place: float | None) -> str:
        loop = f"{bandwidth:g}Hz" if bandwidth else f"{self.bandwidths[0]:g}Hz_plain"
        return f"ball_{loop}_{'free' if place is None else f'{100 * place:.0f}'}"

    def trial_at(self, name: str, place: float | None) -> dict[str, Any]:
        """A trial with a contact at a place, or without any, as plain data."""
        scene = None
        if place is not None:
            x = place * self.geometry.length
            y = beside(self.geometry.arm(), x, self.diameter / 2 + self.speed * self.hit)
            about = {"diameter": self.diameter, "mass": self.mass, "vx": 0.0, "vy": -self.speed}
            scene = {"ball": {**about, "x": float(x), "y": float(y)}}
        return trial(name, self.duration, **both(self.current), scene=scene)

    def _responses(self, sides: Sides, bandwidth: float) -> dict[str, list[dict[str, float]]]:
        """Side -> responses at every place."""
        free = sides[self._name(bandwidth, None)]
        hits = [sides[self._name(bandwidth, place)] for place in self.places]
        return {s: [responses(hit[s], free[s], self.hit) for hit in hits] for s in free}

    def measure(self, sides: Sides) -> list[dict[str, Any]]:
        rows = []
        for bandwidth in self.bandwidths:
            found = self._responses(sides, bandwidth)
            for key, what in READ:
                for k, place in enumerate(self.places):
                    told = {s: r[k] for s, r in found.items() if key in r[k]}
                    rows.append(self._row(f"{what}, {bandwidth:g} Hz, at {place:.0%}", key, told))
                if "robot" in found:
                    sides_with = {s: r for s, r in found.items() if key in r[0]}
                    rows.append(self._agreement(f"{what}, {bandwidth:g} Hz", key, sides_with))
        plain = self._responses(sides, 0.0)
        for key, what in READ[1:]:
            for k, place in enumerate(self.places):
                told = {s: r[k] for s, r in plain.items()}
                where = f"{self.bandwidths[0]:g} Hz, at {place:.0%}"
                rows.append(self._row(f"{what} without feed-forward, {where}", key, told))
        return rows

    def _row(self, what: str, key: str, told: dict[str, dict[str, float]]) -> dict[str, Any]:
        hidden = [s for s, r in told.items() if not visible(r[key], r[f"{key} error"])]
        note = f"not visible: {', '.join(hidden)}" if hidden else ""
        return row(what, "counts", {s: r[key] for s, r in told.items()}, note=note)

    def _agreement(
        self, what: str, key: str, found: dict[str, list[dict[str, float]]]
    ) -> dict[str, Any]:
        """Rank order of all places, model against robot; the paper's claim is a rise to the tip."""
        order = {s: [abs(r[key]) for r in rows] for s, rows in found.items()}
        note = "robot: against the distance from the base"
        judged = all(visible(r[key], r[f"{key} error"]) for r in found["robot"])
        agree = {}
        if judged:
            agree = {s: rank_agreement(order[s], order["robot"]) for s in found if s != "robot"}
            agree["robot"] = rank_agreement(order["robot"], list(self.places))
        else:
            note = "not visible everywhere on the robot, so there is no order"
        met = bool(agree.get("named", np.nan) >= 1.0 - 1e-9) if judged else None
        aim = "same order" if judged else None
        return row(
            f"rank agreement of {what}",
            "1",
            agree,
            paper="rises to the tip",
            aim=aim,
            met=met,
            note=note,
        )

    def curves(self, sides: Sides) -> list[dict[str, Any]]:
        out = []
        fastest, at = self.bandwidths[-1], 100 * np.array(self.places)
        for s, found in self._responses(sides, fastest).items():
            for key, quantity in (("angle", "angle response"), *FIGURES):
                if key not in found[0]:
                    continue
                values = np.array([r[key] for r in found])
                out.append(curve(f"{fastest:g} Hz", quantity, "counts", s, at, values, 1))
        tip, name = self.places[-1], f"{fastest:g} Hz, at {self.places[-1]:.0%}"
        hit, free = (sides[self._name(fastest, place)] for place in (tip, None))
        out += in_time(name, hit, free, self.hit, self.motor)
        along = profile(self.places, geometry=self.geometry)
        for key, unit in PROFILE:
            values = getattr(along, key)
            out.append(curve("nominal arm", f"{key} along the arm", unit, "single", at, values, 1))
        return out
