"""Reference profile of smooth moves from rest to rest."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from spirob.bench.profile import Profile, check


@dataclass(frozen=True, kw_only=True)
class Moves(Profile):
    """Half-cosine moves as pairs [duration, target]; repeat a target to hold.

    x(t) = x_0 + (x_1 - x_0)(1 - cos πu)/2,  u = t/duration.  Acceleration is finite and small,
    so that a geared antagonist, kilograms seen at its tendon, can follow without going slack.
    """

    waypoints: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        pairs: Any = self.waypoints
        if not isinstance(pairs, list | tuple) or not pairs:
            raise ValueError("'waypoints' must be a list of pairs [duration, target]")
        for pair in pairs:
            if not isinstance(pair, list | tuple) or len(pair) != 2:
                raise ValueError(f"'waypoints' must hold pairs [duration, target], not {pair!r}")
            check("waypoints: duration", pair[0], 0.0, above=True)
            check("waypoints: target", pair[1])

    def __call__(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, rate = np.zeros_like(t), np.zeros_like(t)
        begins, level = 0.0, 0.0
        for lasts, target in self.waypoints:
            u = np.clip((t - begins) / lasts, 0.0, 1.0)
            moving = (t >= begins) & (t < begins + lasts)
            value += (target - level) * (1 - np.cos(np.pi * u)) / 2
            rate += moving * (target - level) * np.pi / (2 * lasts) * np.sin(np.pi * u)
            begins, level = begins + lasts, float(target)
        return value, rate
