"""Extreme curl at constant tendon velocity, until the faces meet and the motor is at its limit.

Current and velocity are steady, then both have a knee: the velocity falls, the current rises to the
limit of 5 A.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from spirob.experiments import LIMIT, Experiment, Play, Side, Sides, aimed, curve, plan, row, trial
from spirob.experiments.response import PERIOD, smooth

AIM = 0.05
NAME = "extreme_curl"
FREE = (0.3, 0.6)  # of the knee's time: where the motion is free
SMOOTHING = 21  # samples


def knee(velocity: np.ndarray, current: np.ndarray | None) -> dict[str, float]:
    """Times of the knees [s] and the levels before and after [m/s], [A].

    velocity  falls for good below half of its free value: the knee's time
    current   rises for good past the middle between its free value and its last; NaN without it
    """
    slow = smooth(velocity, SMOOTHING)
    fast = np.flatnonzero(slow >= 0.5 * np.median(slow[slow > 0.5 * slow.max()]))
    stop = int(fast[-1]) + 1
    free = slice(int(FREE[0] * stop), max(int(FREE[1] * stop), int(FREE[0] * stop) + 1))
    found = {"velocity knee": stop * PERIOD, "free velocity": float(np.median(velocity[free]))}
    if current is None:
        return found
    level = smooth(current, SMOOTHING)
    before, after = float(np.median(current[free])), float(np.median(current[-200:]))
    below = np.flatnonzero(level < (before + after) / 2)
    return found | {
        "current knee": float(below[-1] + 1) * PERIOD,
        "free current": before,
        "last current": after,
        "rise": after - before,
    }


@dataclass(frozen=True, kw_only=True)
class ExtremeCurl(Experiment):
    """Left tendon at `speed` [m/s] for `duration` [s], the other unactuated."""

    title: ClassVar[str] = "Extreme curl at constant tendon velocity"
    speed: float = 0.06
    duration: float = 5.0

    def plays(self) -> list[Play]:
        wind = plan("velocity", {"kind": "constant", "value": self.speed, "blend": 0.1})
        idle = plan("current", {"kind": "constant", "value": 0.0})
        return [Play(NAME, trial(NAME, self.duration, wind, idle))]

    def measure(self, sides: Sides) -> list[dict[str, Any]]:
        found = {s: self._knee(side) for s, side in sides[NAME].items()}
        stroke = {s: 1e3 * side.driven("displacement", 0)[-1] for s, side in sides[NAME].items()}
        rows = []
        for key, unit, paper, note in (
            ("velocity knee", "s", None, ""),
            ("current knee", "s", None, ""),
            ("filtered current knee", "s", None, "100-sample mean"),
            ("free velocity", "m/s", None, "the paper does not give its velocity"),
            ("free current", "A", None, ""),
            ("last current", "A", LIMIT, "saturation of the drive"),
        ):
            values = {s: f[key] for s, f in found.items() if key in f}
            aim = aimed(values, AIM) if key.endswith("knee") else {}
            rows.append(row(key, unit, values, paper=paper, note=note, **aim))
        return [*rows, row("stroke at the end", "mm", stroke)]

    def _knee(self, side: Side) -> dict[str, float]:
        velocity = side.driven("velocity", 0)
        if side.current is None:
            return knee(velocity, None)
        mean = knee(velocity, side.driven("filtered", 0))["current knee"]
        return knee(velocity, side.driven("current", 0)) | {"filtered current knee": mean}

    def curves(self, sides: Sides) -> list[dict[str, Any]]:
        out = []
        for name, side in sides[NAME].items():
            speed = 1e3 * smooth(side.driven("velocity", 0), SMOOTHING)
            out.append(curve("curl", "velocity", "mm/s", name, side.seconds, speed))
            if side.current is not None:
                for signal in ("current", "filtered"):
                    felt = side.driven(signal, 0)
                    out.append(curve("curl", signal, "A", name, side.seconds, felt))
        return out
