"""Where a motion leaves the range in which a law was taught: there it says nothing."""

from collections.abc import Mapping, Sequence

import numpy as np

from spirob.effects import Effect
from spirob.machine.inverse import InverseProblem

ROOM = 0.05  # of the range, beyond either end
SAID = {
    "winch.displacement": "place",
    "motor.angle": "angle",
    "motor.speed": "speed",
    "motor.load_torque": "load",
    "time": "time since a trial's beginning",
}


def beyond(
    problems: Sequence[InverseProblem],
    effects: Sequence[type[Effect]],
    changes: Mapping[str, float],
) -> list[str]:
    """Sentences, one for each signal of each law that leaves its range in some log."""
    said = []
    for effect in effects:
        for argument, (low, high) in effect.taught.items():
            signal = effect.reads[argument]
            shares = [_outside(p, changes, signal, low, high) for p in problems if signal in SAID]
            if any(shares):
                said.append(
                    f"{effect.name()}: the {SAID[signal]} leaves the range that taught this law, "
                    f"{low:.3g} to {high:.3g}, in up to {max(shares):.0%} of the time: there it "
                    "says nothing."
                )
    return said


def _outside(
    problem: InverseProblem, changes: Mapping[str, float], signal: str, low: float, high: float
) -> float:
    """Share of the compared samples of which a signal is outside of a range."""
    vector = problem.table.vector(problem.completed(changes))
    motion = problem.asked.seen(vector)
    signals = problem.asked.signals(motion, problem.asked.load(motion, vector))
    values, room = problem.thinned(signals[signal]), ROOM * (high - low)
    return float(np.mean((values < low - room) | (values > high + room)))
