"""Active contact: the arm, curled up, uncurls until it meets a peg, and recoils.

The right tendon runs at constant velocity throughout: paid out while the left one curls the arm,
wound in while it uncurls, paid out again.  The peg stands on the right of the straight arm, so that
the arm does not meet it while it curls.  The detector listens to the right current while the arm
uncurls, from `settle` seconds on: the start of the motion is a rise of its own.  It is the detector
that begins the recoil, on the robot and in each model by what that side itself feels; only without
a contact does the recoil come when the uncurling is over.  Every trial is played twice, with the
detector on the raw and on the filtered current.  When a detector speaks and what a current is are
two questions: currents are compared "under identical conditions" (paper), in models that move as
the robot did and recoil when it did, and with each side's own recoil beside.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np

from spirob.errors import DataError
from spirob.experiments import (
    SIDES,
    Experiment,
    Play,
    Side,
    Sides,
    curve,
    plan,
    row,
    trial,
)
from spirob.experiments.response import (
    PERIOD,
    Recoil,
    Repeat,
    detected,
    each_in_its_own,
    in_one_motion,
    onset,
)
from spirob.perceive.contact import ContactSettings
from spirob.trials.trial import beside

RIGHT = 1
RESTS = 0.3  # s before and after the motion
AWAY = 2.0  # m, beyond the arm's reach: where the peg of a free motion stands
RAW = "current"
SIGNALS = (RAW, "filtered")


def _told(signal: str) -> str:
    return RAW if signal == RAW else f"{signal} {RAW}"


def _where(place: float | None) -> str:
    return "free" if place is None else f"contact at {place:.0%}"


@dataclass(frozen=True, kw_only=True)
class ActiveContact(Experiment):
    """places     of the peg along the straight arm;  gap to it, diameter of it [m]
    speed      of the right tendon [m/s];  curl, uncurl, recoil [s]  how long each takes
    high, low  current of the left motor while it curls and while it gives way [A]
    settle     of the uncurling until the detector listens [s]
    again      how many times more the robot plays each contact, to compare it with itself
    """

    title: ClassVar[str] = "Active contact while uncurling"
    motor: ClassVar[int] = RIGHT
    places: tuple[float, ...] = (0.5, 0.7, 0.9)
    gap: float = 0.01
    diameter: float = 0.03
    speed: float = 0.05
    curl: float = 3.0
    uncurl: float = 5.0
    recoil: float = 1.0
    high: float = 0.6
    low: float = 0.15
    settle: float = 0.3
    again: int = 4

    @property
    def begins(self) -> float:
        """When the uncurling begins [s]."""
        return RESTS + self.curl + RESTS

    def plays(self) -> list[Play]:
        wanted = [(place, signal) for signal in SIGNALS for place in (None, *self.places)]
        more = [(place, s, k + 1) for place, s in wanted if place for k in range(self.again)]
        return [self._play(*one) for one in wanted] + [self._once_more(*one) for one in more]

    def _play(self, place: float | None, signal: str) -> Play:
        return Play(
            self._name(place, signal),
            self._trial(place, signal),
            only=() if signal == RAW else ("robot", "base", "named"),
            react=partial(self._recoil, signal),
            repeat=None if place is None else partial(self._repeat, signal),
        )

    def _once_more(self, place: float, signal: str, again: int) -> Play:
        """The same trial on the robot alone: nothing differs but what the robot itself varies."""
        name = self._name(place, signal, again)
        plain = {**self._trial(place, signal), "name": name}
        return Play(name, plain, only=("robot",), react=partial(self._recoil, signal))

    def _recoil(self, signal: str) -> Recoil:
        return Recoil(RIGHT, signal != RAW, *self.window(), ContactSettings())

    def _repeat(self, signal: str, robot: Side) -> Repeat:
        first, last = self.window()
        told = detected(robot.driven(signal, RIGHT), first, last, ContactSettings())
        return Repeat(None if np.isnan(told) else round(told / PERIOD), first, last)

    def _name(self, place: float | None, signal: str = RAW, again: int = 0) -> str:
        how = [] if signal == RAW else [signal]
        which = [f"again{again}"] if again else []
        where = "free" if place is None else f"{100 * place:.0f}"
        return "_".join(["uncurl", *how, *which, where])

    def _trial(self, place: float | None, signal: str) -> dict[str, Any]:
        v = self.speed
        speeds = [[RESTS, 0.0], [self.curl, -v], [RESTS, 0.0], [self.uncurl, v]]
        away = self.uncurl + RESTS
        pulls = [[RESTS, self.low], [self.curl, self.high], [away, self.low], [1.0, self.high]]
        right = plan("velocity", {"kind": "steps", "plateaus": [*speeds, [1, -v]], "blend": 0.2})
        left = plan("current", {"kind": "steps", "plateaus": pulls, "blend": 0.2})
        # without a peg the arm's touching itself is solved with other rounding, and slips come at
        # other times; out of reach, all is alike until the contact
        x, y = self.geometry.length, -AWAY
        if place is not None:
            x = place * self.geometry.length
            y = -beside(self.geometry.arm(), x, self.diameter / 2 + self.gap)
        scene = {"cylinder": {"diameter": self.diameter, "x": float(x), "y": float(y)}}
        duration = self.begins + self.uncurl + self.recoil
        return trial(self._name(place, signal), duration, left, right, scene)

    def window(self) -> tuple[int, int]:
        """First sample of the watch, and the one after its last, where the recoil begins."""
        return (
            round((self.begins + self.settle) / PERIOD),
            round((self.begins + self.uncurl) / PERIOD),
        )

    def judge(self, side: Side, free: Side, signal: str) -> dict[str, float]:
        """Onset, detection and delay [s] of one trial of one side."""
        first, last = self.window()
        found = detected(side.driven(signal, RIGHT), first, last, ContactSettings())
        alone = detected(free.driven(signal, RIGHT), first, last, ContactSettings())
        # from its recoil on a motion is another one
        ends, free_ends = (last if np.isnan(t) else round(t / PERIOD) + 1 for t in (found, alone))
        began = onset(
            side.driven("current", RIGHT)[:ends], free.driven("current", RIGHT)[:free_ends], first
        )
        return {"onset": began, "detected": found, "delay": found - began}

    def measure(self, sides: Sides) -> list[dict[str, Any]]:
        sensed = [s for s, side in sides[self._name(None)].items() if side.current is not None]
        if not sensed:
            raise DataError("active_contact: no side has a current")
        rows = [self._error(sides, place, s) for s in SIGNALS for place in (None, *self.places)]
        rows += [self._error_apart(sides, place, s) for s in SIGNALS for place in self.places]
        for signal in SIGNALS:
            rows += self._contacts(sides, signal, sensed)
        return rows

    def _contacts(self, sides: Sides, signal: str, sensed: list[str]) -> list[dict[str, Any]]:
        """False and missed contacts and delays, with the detector on one signal."""
        free = sides[self._name(None, signal)]
        alarms = {s: self.judge(free[s], free[s], signal)["detected"] for s in sensed}
        false = {s: float(np.isfinite(t)) for s, t in alarms.items()}
        met = false.get("robot") == 0.0 if "robot" in false else None
        what = f"false contacts in free uncurling, {signal}"
        rows = [row(what, "1", false, aim="0", met=met)]
        missed = dict.fromkeys(sensed, 0.0)
        for place in self.places:
            played = sides[self._name(place, signal)]
            told = {s: self.judge(played[s], free[s], signal) for s in sensed}
            missed = {s: missed[s] + (not told[s]["delay"] > -0.02) for s in sensed}
            rows.append(self._recoils(sides, place, signal, told))
            delay = {s: 1e3 * t["delay"] for s, t in told.items()}
            note = "from the current's parting from free motion to the decision"
            rows.append(row(f"delay of contact at {place:.0%}, {signal}", "ms", delay, note=note))
        met = missed.get("robot") == 0.0 if "robot" in missed else None
        return [*rows, row(f"missed contacts, {signal}", "1", missed, aim="0", met=met)]

    def _recoils(
        self, sides: Sides, place: float, signal: str, told: Mapping[str, Mapping[str, float]]
    ) -> dict[str, Any]:
        """When each side recoils, and how far that varies from play to play of the robot."""
        first, last = self.window()
        robots = self._robots(sides, place, signal)
        plays = [detected(r.driven(signal, RIGHT), first, last, ContactSettings()) for r in robots]
        note = "after the uncurling began"
        if len(plays) > 1:
            each = ", ".join(f"{t - self.begins:.2f}" for t in sorted(plays))
            note = f"{note}; {len(plays)} plays of the robot: {each}"
        recoils = {s: t["detected"] - self.begins for s, t in told.items()}
        return row(f"recoil from contact at {place:.0%}, {signal}", "s", recoils, note=note)

    def _error(self, sides: Sides, place: float | None, signal: str) -> dict[str, Any]:
        """Of the signal to which the detector listens: the paper's currents are filtered ones."""
        what = f"{_told(signal)} RMSE against the robot, {_where(place)}"
        played = sides[self._name(place, signal)]
        return in_one_motion(what, played, signal, RIGHT, recoils=place is not None)

    def _error_apart(self, sides: Sides, place: float, signal: str) -> dict[str, Any]:
        """The same where each recoils when its own detector speaks."""
        what = f"{_told(signal)} RMSE, each with its own recoil, {_where(place)}"
        robots = self._robots(sides, place, signal)
        return each_in_its_own(what, robots, sides[self._name(place, signal)], signal, RIGHT)

    def _robots(self, sides: Sides, place: float, signal: str) -> list[Side]:
        """What the robot did in every play of one trial."""
        played = [sides[self._name(place, signal, k)] for k in range(self.again + 1)]
        return [sides["robot"] for sides in played if "robot" in sides]

    def curves(self, sides: Sides) -> list[dict[str, Any]]:
        out = []
        for place in (None, *self.places):
            play = "free" if place is None else f"peg at {place:.0%}"
            for s, side in sides[self._name(place)].items():
                if s in SIDES and side.current is not None:
                    for signal in SIGNALS:
                        felt = side.driven(signal, RIGHT)
                        out.append(curve(play, signal, "A", s, side.seconds, felt))
        return out
