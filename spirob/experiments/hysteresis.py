"""Hysteresis: displacement over a tendon force that rises and falls in straight lines.

The loop's area ∮ F dx is the energy that drive, gear, tendon and arm keep in one period.  The last
whole period counts; before it the antagonist settles.  A period is long, so that the arm follows
without swinging: at 5 s the baseline's swing encloses two thirds of the robot's area.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from spirob.experiments import Experiment, Play, Side, Sides, aimed, curve, plan, row, trial
from spirob.experiments.response import PERIOD

AIM = 0.1  # of the robot's
NONE = 0.05  # of the robot's: a loop as small as that is about none
ABOUT_NONE = "about 0: at most 5 % of the robot's"
NAME = "hysteresis"


def loop_area(force: np.ndarray, displacement: np.ndarray) -> float:
    """Area enclosed by displacement over force [N·m = J], positive where displacement lags.

    The ends are joined by a straight line.
    """
    x, y = np.append(force, force[0]), np.append(displacement, displacement[0])
    return float(np.sum((x[1:] + x[:-1]) / 2 * np.diff(y)))


@dataclass(frozen=True, kw_only=True)
class Hysteresis(Experiment):
    """Force from `low` to `high` [N] and back within `period` [s], `periods` times.

    antagonist  constant current of the other motor [A], which keeps its tendon from running out
    """

    title: ClassVar[str] = "Hysteresis under triangular force"
    low: float = 0.5
    high: float = 3.0
    period: float = 20.0
    periods: float = 2.0
    antagonist: float = 0.05

    def plays(self) -> list[Play]:
        triangle = {
            "kind": "triangle",
            "low": self.low,
            "high": self.high,
            "period": self.period,
            "blend": 0.05,
        }
        idle = plan("current", {"kind": "constant", "value": self.antagonist})
        plain = trial(NAME, self.period * self.periods, plan("force", triangle), idle)
        return [Play(NAME, plain)]

    def _loop(self, side: Side) -> tuple[np.ndarray, np.ndarray]:
        """Commanded force [N] and displacement [m] of the last period."""
        last = slice(-round(self.period / PERIOD), None)
        phase = (side.seconds[last] % self.period) / self.period
        force = self.low + (self.high - self.low) * (1 - np.abs(2 * phase - 1))
        return force, side.driven("displacement", 0)[last]

    def measure(self, sides: Sides) -> list[dict[str, Any]]:
        loops = {name: self._loop(side) for name, side in sides[NAME].items()}
        area = {s: 1e3 * loop_area(f, x) for s, (f, x) in loops.items()}
        stroke = {s: 1e3 * np.ptp(x) for s, (_, x) in loops.items()}
        box = {s: np.ptp(force) * stroke[s] for s, (force, _) in loops.items()}
        width = {s: area[s] / box[s] if box[s] > 0.0 else np.nan for s in loops}
        note = "the paper shows a loop and gives no number"
        return [
            row("area of the loop", "mJ", area, note=note, **aimed(area, AIM)),
            row("area of the baseline's loop", "mJ", area, aim=ABOUT_NONE, met=_none(area)),
            row("area over force range times stroke", "1", width),
            row("stroke", "mm", stroke),
        ]

    def curves(self, sides: Sides) -> list[dict[str, Any]]:
        out = []
        for name, side in sides[NAME].items():
            force, moved = self._loop(side)
            out.append(curve("loop", "displacement over force", "mm", name, force, 1e3 * moved))
            for signal, quantity in (("current", "current"), ("filtered", "filtered current")):
                if side.current is not None:
                    felt = side.driven(signal, 0)[-len(force) :]
                    out.append(curve("loop", f"{quantity} over force", "A", name, force, felt))
        return out


def _none(area: Mapping[str, float]) -> bool | None:
    """Whether the baseline has about no loop; None where one of the two did not play."""
    if not {"robot", "single"} <= set(area):
        return None
    return bool(abs(area["single"]) <= NONE * abs(area["robot"]))
