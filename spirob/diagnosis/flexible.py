"""The flexible ceiling: how much of what a model leaves could still be explained, by any law.

Trees learn the residual of the training trials from the motion and from the model's own effort.
The measured effort is no input: its noise is in the residual, and would be found there again.  A
ceiling is reported beside the ladder; no verdict looks at it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from threadpoolctl import threadpool_limits

from spirob.diagnosis.trees import folds_of, left_out, share, tree, worth
from spirob.identify.problem import Problem, Stretch


@dataclass(frozen=True)
class Ceiling:
    """What a flexible residual on top of a model leaves.

    left   role -> model minus measurement of the effort that is left, (n,) in its unit
    share  of the squared training residual that is explained on folds left out
    """

    left: dict[str, np.ndarray]
    share: float


def ceiling(problems: Mapping[str, Problem], missed: Mapping[str, np.ndarray]) -> Ceiling:
    """Fit the flexible residual; `missed` is model minus measurement by role, (N,) each.

    On training trials, "train", what is left is of trees fitted to the other trials.  All is taken
    away by the factor by which that came closest, so no more is left than was there to be learned.
    """
    inputs = _inputs(problems, missed)
    rest = {role: values[problems[role].rows] for role, values in missed.items()}
    train = problems["train"]
    # few samples for each tree: threads that wait cost more than they win, and might round apart
    with threadpool_limits(1):
        folds = folds_of(train.edges)[train.rows]
        found = rest["train"] - left_out(inputs["train"], rest["train"], folds)
        trees = tree().fit(inputs["train"], rest["train"])
        guess = {r: found if r == "train" else trees.predict(inputs[r]) for r in rest}
    factor = worth(rest["train"], found)
    left = {role: rest[role] - factor * guess[role] for role in rest}
    return Ceiling(left, share(rest["train"], left["train"]))


def _inputs(
    problems: Mapping[str, Problem], missed: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """What the trees see, by role: (n, 8)."""
    stretches = {role: problems[role].stretches() for role in missed}
    channels = sorted({s.channel for found in stretches.values() for s in found})
    inputs = {}
    for role, values in missed.items():
        modelled = (problems[role].measured() + values)[problems[role].rows]
        motion = [_motion(s, channels) for s in stretches[role]]
        inputs[role] = np.column_stack([np.concatenate(motion), modelled])
    return inputs


def _motion(piece: Stretch, channels: Sequence[str]) -> np.ndarray:
    """Position, speed, direction, acceleration, time, time since a reversal, motor, (n, 7)."""
    seconds, velocity = piece.seconds, piece.velocity
    turns = np.flatnonzero(np.diff(np.sign(velocity)) != 0) + 1
    begun = seconds[np.concatenate([[0], turns])]
    since = seconds - begun[np.searchsorted(turns, np.arange(len(seconds)), "right")]
    motor = np.full(len(seconds), float(channels.index(piece.channel)))
    direction = np.tanh(velocity / piece.still)
    faster = np.gradient(velocity, seconds)
    return np.column_stack([piece.position, velocity, direction, faster, seconds, since, motor])
