"""What a residual depends on: the share of it that a flexible model of each signal foretells.

Boosted trees learn the residual from one signal on some folds and are scored on those left out, so
a share says what comes again, and of noise it is none.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from threadpoolctl import threadpool_limits

from spirob.diagnosis.spectrum import Order
from spirob.diagnosis.trees import left_out, share
from spirob.identify.problem import Problem, Stretch

BLOCKS = 5  # folds of half-second blocks, where a motor has no second trial
TOGETHER = "all but time"  # of one trial only there is nothing in its time that comes again
SINGLE = 0.3  # of what all explain together: what one signal has to do by itself to be named
LITTLE = 0.2  # of the residual: who foretells no more does not describe it
NOTHING = 0.05  # a signal that foretells less of the residual is none that it depends on


def dependence(residual: Problem, values: np.ndarray) -> dict[str, float]:
    """Signal -> share of the squared residual (N,) that it explains by itself on folds left out.

    A fold is a trial where every motor has several, else half-second blocks.
    """
    pieces = residual.stretches()
    features = _features(pieces)
    features[TOGETHER] = [c for n, own in features.items() if n != "time" for c in own]
    folds = _folds(pieces, residual.block)
    with threadpool_limits(1):  # small trees lose more time to waiting threads than they win
        return {
            name: share(values, left_out(np.column_stack(columns), values, folds))
            for name, columns in features.items()
        }


def told(alone: Mapping[str, float], waves: Sequence[Order] = ()) -> str:
    """A sentence on what a residual depends on.

    alone  as `dependence` returned it;  waves  those that come again in every trial
    """
    singles = {name: value for name, value in alone.items() if name != TOGETHER}
    whole, best = alone[TOGETHER], max(singles.values())
    if NOTHING < max(best, whole) <= LITTLE:
        said = f"Little of the residual comes again in another trial ({max(best, whole):.0%} of it)"
    elif best > max(NOTHING, SINGLE * whole):
        said = f"The residual depends on {named(singles)}"
    elif whole > NOTHING:
        said = f"The residual depends on several signals together ({whole:.0%} of it)"
    else:
        said = (
            f"The residual follows none of {', '.join(singles)} from one trial to another, nor all "
            "of these together"
        )
    for wave in sorted(waves, key=lambda w: -w.share_of_error)[:1]:
        turns = "the motor" if wave.of == "motor" else "the gear's output"
        said += (
            f"; {wave.share_of_error:.0%} is a wave of {wave.order:.3g} periods a turn of {turns}"
        )
    return f"{said}."


def named(alone: Mapping[str, float]) -> str:
    """The signals that explain most, "speed (40% by itself) and load (25% by itself)"."""
    strong = sorted(alone, key=lambda name: -alone[name])
    most = alone[strong[0]]
    return " and ".join(
        f"{name} ({alone[name]:.0%} by itself)" for name in strong if alone[name] > 0.4 * most
    )


def _features(pieces: Sequence[Stretch]) -> dict[str, list[np.ndarray]]:
    """Signal -> columns along the residual, the motor's number last."""

    def joined(of: Sequence[np.ndarray]) -> np.ndarray:
        return np.concatenate(list(of))

    channels = list(dict.fromkeys(p.channel for p in pieces))
    motor = joined([np.full(len(p.seconds), float(channels.index(p.channel))) for p in pieces])
    speed = joined([p.velocity for p in pieces])
    direction = joined([np.tanh(p.velocity / p.still) for p in pieces])
    return {
        "position": [joined([p.position for p in pieces]), motor],
        "speed": [speed, direction, motor],
        "acceleration": [joined([np.gradient(p.velocity, p.seconds) for p in pieces]), motor],
        "load": [joined([p.effort for p in pieces]), motor],
        "time": [joined([p.seconds for p in pieces]), motor],
    }


def _folds(pieces: Sequence[Stretch], block: int) -> np.ndarray:
    """Fold of each sample, (N,)."""
    trials = list(dict.fromkeys(p.trial for p in pieces))
    several = all(len({q.trial for q in pieces if q.channel == p.channel}) > 1 for p in pieces)
    if several:
        return np.concatenate([np.full(len(p.seconds), trials.index(p.trial)) for p in pieces])
    samples = np.arange(sum(len(p.seconds) for p in pieces))
    return samples // block % BLOCKS
