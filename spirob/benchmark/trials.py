"""The trials that are timed: smooth moves of one tendon against a small current of the other."""

import numpy as np

from spirob.bench.trial import Trial
from spirob.control.law import CURRENT, VELOCITY
from spirob.control.schedule import Schedule

WIND_IN = 0.05  # m/s
HOLD = 0.2  # A


def winding(seconds: float) -> Schedule:
    """The left tendon wound in at 50 mm/s, the right motor at 0.2 A."""
    reference = np.tile([WIND_IN, HOLD], (round(seconds * 1000), 1))
    mode = np.array([VELOCITY, CURRENT])
    return Schedule(mode, reference, np.zeros_like(reference), np.full(2, 5.0))


def moving(name: str, pulling: str, seconds: float, depth: float = 1.0) -> Trial:
    """Out, back and out again, slow enough that the other tendon stays taut.

    depth  how far, and so how fast, relative to 7 mm/s
    """
    stroke = 0.007 * depth * seconds  # the same speeds however short the trial
    shares = ((0.4, 1.0), (0.1, 1.0), (0.35, 0.3), (0.15, 0.6))
    waypoints = [[time * seconds, share * stroke] for time, share in shares]
    moves = {
        "mode": "displacement",
        "current_limit": 5.0,
        "profile": {"kind": "moves", "waypoints": waypoints},
    }
    hold = {
        "mode": "current",
        "current_limit": 5.0,
        "profile": {"kind": "constant", "value": HOLD, "blend": 0.1 * seconds},
    }
    held = {"left": "right", "right": "left"}[pulling]
    motors = {pulling: moves, held: hold}
    return Trial.from_plain({"name": name, "role": "train", "duration": seconds, "motors": motors})
