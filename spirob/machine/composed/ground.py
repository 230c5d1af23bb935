"""What a law is composed from: what a model leaves on which motion, and how a torque would show.

No rig and no arm: columns, folds, a residual and its slopes by the fitted numbers.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spirob.diagnosis.criteria import Worth
from spirob.identify.descent import slopes_ahead
from spirob.identify.scaling import Scaling
from spirob.machine.composed.track import Ranges, Track, ranges_of
from spirob.machine.inverse import InverseProblem
from spirob.machine.models import STEP, RigSearch

TINY = 1e-9  # of a coordinate: room that a bound leaves at least


@dataclass(frozen=True)
class Side:
    """The trials of one role beside a fitted model, to first order.

    track     their motion, all n samples
    residual  model minus measurement, (N,);  slopes  of it by the numbers' coordinates, (N, k)
    shown     what a further torque on the axis, (n,), changes of the residual, (N,)
    thinned   of values at every sample, (n,), those that teach the law
    motors    (n,) of each motor, 1 where a sample is its: a term has a size in each
    """

    track: Track
    residual: np.ndarray
    slopes: np.ndarray
    shown: Callable[[np.ndarray], np.ndarray]
    thinned: Callable[[np.ndarray], np.ndarray]
    motors: tuple[np.ndarray, ...] = ()


@dataclass(frozen=True)
class Ground:
    """A fitted model beside which a law is composed.

    changes    its numbers;  low, high  how far their coordinates may move, (k,) each
    ranges     that teach the law
    folds      (N,) label of each training sample, one run of samples a fold
    edges, block  of the samples over which errors are resampled, as `block_errors` takes them
    worth      the questions that a term has to pass
    moved      the same at other coordinates, by how much they move, (k,)
    """

    train: Side
    heldout: Side
    changes: dict[str, float]
    low: np.ndarray
    high: np.ndarray
    ranges: Ranges
    folds: np.ndarray
    edges: np.ndarray
    block: int
    worth: Worth
    progress: Callable[[str], None]
    moved: Callable[[np.ndarray], "Ground"]


def room(scaling: Scaling, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How far coordinates may move from where they are, (k,) each."""
    return np.minimum(scaling.low - at, -TINY), np.maximum(scaling.high - at, TINY)


def ground_of(
    search: RigSearch,
    names: Sequence[str],
    changes: Mapping[str, float],
    ranges: Ranges | None = None,
) -> Ground:
    """That of a rig at these changes, of which the named numbers are fitted.

    ranges  that teach the law, where they are known already
    """
    train = search.models.train
    scaling = Scaling(train.table, list(names))
    fixed = {name: value for name, value in changes.items() if name not in set(names)}
    at = np.clip(scaling.scaled(changes), scaling.low, scaling.high)
    inside = {**fixed, **scaling.physical(at)}

    def side(problem: InverseProblem) -> Side:
        value = problem(inside)
        return Side(
            Track.of(problem, inside),
            value,
            slopes_ahead(problem, scaling, at, fixed, value, STEP),
            lambda torque: problem.shown(torque, inside),
            problem.thinned,
        )

    own = side(train)
    used = {name: train.thinned(values) for name, values in own.track.signals.items()}
    turn = 2 * np.pi if train.sizes.axis_unit == "rad" else 0.0
    gives = train.asked.own(train.table.vector(inside))["scale"]
    taught = ranges or ranges_of(used, train.rest_speed, turn, gives)

    def moved(by: np.ndarray) -> Ground:
        there = np.clip(scaling.scaled(inside) + by, scaling.low, scaling.high)
        return ground_of(search, names, {**fixed, **scaling.physical(there)}, taught)

    return Ground(
        own,
        side(search.models.heldout),
        inside,
        *room(scaling, at),
        taught,
        search.models.folds,
        train.edges,
        train.block,
        search.worth,
        search.progress,
        moved,
    )
