"""What a law is composed from: what a model leaves on which motion, and how a torque would show.

Columns, folds, a residual and its slopes by the fitted numbers, of a rig's effort, or of the
currents of the arm's motors.  There a torque τ on the rotors changes the current of a motor that
follows a motion by what it has to make up for; beside a motor whose current is commanded it also
holds against what that one then pulls more, through the arm, which is light and bends as far as
before:

    Δi = -(τ - τ_other)/(η k_t)

The law is one for both motors, each with its own motion.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spirob.diagnosis.criteria import HALF, Criteria, Settings, Worth
from spirob.effects import Effect
from spirob.identify.descent import slopes_ahead
from spirob.identify.fit import STEPS
from spirob.identify.measurement import Measurement
from spirob.identify.problem import effort_rms
from spirob.identify.residual import Residual
from spirob.identify.scaling import Scaling
from spirob.machine.composed.track import Ranges, Track, ranges_of
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.search.models import STEP, RigSearch
from spirob.plant import Plant
from spirob.plant.motor import own
from spirob.robot import MOTORS

TINY = 1e-9  # of a coordinate: room that a bound leaves at least
CYCLE, EVERY = 1e-3, 5  # s of a trial's cycle; cycles from one sample of a law to the next
PLACES = ("winch.displacement", "motor.angle")  # of which a law of the place may be
WHOLE = 10**9  # samples: a block is what two edges hold


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


@dataclass(frozen=True)
class _Motors:
    """What a torque at the rotors meets: numbers of the left and right motor, (2,).

    per_torque  current for a torque [A/(N·m)];  turn  of the rotor over the wound-in length [rad/m]
    """

    per_torque: np.ndarray
    turn: float

    @classmethod
    def of(cls, problem: Residual, changes: Mapping[str, float]) -> "_Motors":
        table = problem.table
        vector = table.vector(changes)

        def number(name: str) -> float:
            return float(vector[table.position(name)])

        mean, apart = number("winch.efficiency"), number("winch.efficiency_difference")
        efficiency = np.array([own(mean, apart, m) for m in range(len(MOTORS))])
        constant = number("motor.torque_constant")
        return cls(1.0 / (efficiency * constant), turn_of(problem))


def turn_of(problem: Residual) -> float:
    """Of a rotor over the wound-in length [rad/m]."""
    winch = problem.plant.rig.winch
    return winch.gear_ratio / winch.radius


def lean(problem: Residual, changes: Mapping[str, float], more: Sequence[type[Effect]]) -> Residual:
    """The same trials with a model that holds what these numbers switch on, and `more`."""
    old = problem.plant
    values = dict(zip(old.table.names, old.table.vector(changes).tolist(), strict=True))
    there = [
        e
        for e in old.effects
        if any(values[f"{e.name()}.{f}"] != neutral for f, neutral in e.neutral.items())
    ]
    made = Plant(old.rig, [*there, *more], old.substeps)
    about = made.table.about
    differ = {n: a for n, a in old.table.about.items() if n in about and about[n] != a}
    made = made.within(differ) if differ else made
    made.scatter = old.scatter
    return replace(problem, plant=made)


def arm_ground(
    train: Residual,
    other: Residual,
    names: Sequence[str],
    changes: Mapping[str, float],
    position: str,
    settings: Settings,
    progress: Callable[[str], None],
) -> Ground:
    """That of the arm with these numbers, of which the named ones are fitted.

    train, other  trials that were fitted, and others that a term must not contradict
    position      the signal that is the place, one of `PLACES`

    The model is linearised once: what a law makes of it, its fit in full tells.
    """
    scaling = Scaling(train.table, list(names))
    fixed = {name: value for name, value in changes.items() if name not in set(names)}
    table = train.table
    whole = dict(zip(table.names, table.vector(changes).tolist(), strict=True))
    at = scaling.scaled(whole)
    sides = []
    for problem in (train, other):
        value = problem(changes)
        slopes = slopes_ahead(problem, scaling, at, fixed, value, STEPS[-1])
        sides.append(_side(problem, changes, value, slopes, position))
    own_side, groups = sides[0]
    floor = Criteria(floor=settings.floor, seed=settings.seed)
    ground: list[Ground] = []
    ground.append(
        Ground(
            own_side,
            sides[1][0],
            dict(changes),
            *room(scaling, at),
            _ranges(own_side, train, changes, position),
            groups[:, 0],
            np.append(np.flatnonzero(np.diff(groups[:, 1], prepend=-1)), len(groups)),
            WHOLE,
            Worth(floor, settings.floor * effort_rms(train)),
            progress,
            lambda by: ground[0],
        )
    )
    return ground[0]


def _ranges(side: Side, problem: Residual, changes: Mapping[str, float], position: str) -> Ranges:
    used = {name: side.thinned(values) for name, values in side.track.signals.items()}
    turning = position == "motor.angle"
    rest = float(problem.table.vector(changes)[problem.table.position("motor.rest_speed")])
    gear = 1.0 if turning else turn_of(problem)
    whole = ranges_of(used, rest, 2.0 * np.pi if turning else 0.0)
    return replace(whole, position=position, gear=gear)


def _side(
    problem: Residual,
    changes: Mapping[str, float],
    value: np.ndarray,
    slopes: np.ndarray,
    position: str,
) -> tuple[Side, np.ndarray]:
    """The trials of one role, and of each sample the fold and the half second, (N, 2).

    Samples stand in the order of these; they are weighted so that their mean square is that of the
    effort alone, to which lengths and commanded currents add.
    """
    motors = _Motors.of(problem, changes)
    signals: list[dict[str, np.ndarray]] = []
    rows, groups, first = [], [], 0
    for k, trial in enumerate(problem.trials):
        response, cycles = problem.respond(changes, k), problem.cycles(trial)
        for m in range(len(MOTORS)):
            wound, rate, tension = (
                values[::EVERY, m]
                for values in (response.displacement, response.velocity, response.tension)
            )
            angle = trial.first_angle[m] + motors.turn * wound
            signals.append(
                {
                    "place": angle if position == "motor.angle" else wound,
                    "speed": motors.turn * rate,
                    "load": tension / motors.turn,
                    "time": trial.seconds[::EVERY],
                }
            )
        seconds = trial.seconds[cycles]
        late, block = seconds > 0.5 * seconds[-1], (seconds / HALF).astype(int)
        for m in _order(problem, trial):
            rows.append(first + m * _samples(trial) + cycles // EVERY)
            groups.append(np.column_stack([2 * k + late, WHOLE * k + 2 * block + late]))
        first += len(MOTORS) * _samples(trial)
    index, label = np.concatenate(rows), np.concatenate(groups)
    order = np.lexsort((label[:, 1], label[:, 0]))
    weight = 1.0 / np.sqrt(np.mean(problem.rows))
    joined = {name: np.concatenate([one[name] for one in signals]) for name in signals[0]}
    starts = np.cumsum([0, *(len(one["time"]) for one in signals)])
    track = Track(joined, starts, np.full(len(signals), EVERY * CYCLE))
    passed = [_passed(problem, trial) for trial in problem.trials]

    def shown(torque: np.ndarray) -> np.ndarray:
        return weight * _shown(problem, motors, passed, torque)[order]

    side = Side(
        track,
        weight * value[order],
        weight * slopes[order],
        shown,
        lambda values: np.asarray(values[index[order]]),
        _each(starts),
    )
    return side, label[order]


def _each(starts: np.ndarray) -> tuple[np.ndarray, ...]:
    """The samples of each motor: of a trial they stand one motor after the other."""
    motor = np.repeat(np.arange(len(starts) - 1) % len(MOTORS), np.diff(starts))
    return tuple((motor == m).astype(float) for m in range(len(MOTORS)))


def _order(problem: Residual, trial: Measurement) -> list[int]:
    """The motor of each part of a trial's residual."""
    driven = problem.driven(trial)
    others = [m for m in range(len(MOTORS)) if m not in driven] if driven else []
    return [*driven, *(others if problem.length else []), *(others if problem.length else [])]


def _samples(trial: Measurement) -> int:
    """Of a law in a trial, for each motor."""
    return -(-len(trial.current) // EVERY)


def _passed(problem: Residual, trial: Measurement) -> np.ndarray:
    """What the residual's filter leaves of each sample of a law, drawn straight to the next, as it
    is weighted."""
    at, cycles = np.arange(_samples(trial)), np.arange(len(trial.current)) / EVERY
    drawn = np.array([np.interp(cycles, at, one) for one in np.eye(len(at))])
    passed = problem.filter(drawn, trial.name)[:, problem.cycles(trial)]
    return np.asarray((problem.weight(trial) * passed).T)


def _shown(
    problem: Residual, motors: _Motors, passed: Sequence[np.ndarray], torque: np.ndarray
) -> np.ndarray:
    """What a torque at the rotors, (n,), changes of the residual, (N,)."""
    parts, first = [], 0
    for trial, matrix in zip(problem.trials, passed, strict=True):
        count = _samples(trial)
        both = torque[first : first + len(MOTORS) * count].reshape(len(MOTORS), count)
        first += len(MOTORS) * count
        driven = problem.driven(trial)
        pulled = sum(both[m] for m in range(len(MOTORS)) if m not in driven)
        for m in driven:
            parts.append(matrix @ (-motors.per_torque[m] * (both[m] - pulled)))
        further = len(_order(problem, trial)) - len(driven)
        parts.append(np.zeros(further * len(problem.cycles(trial))))
    return np.concatenate(parts)
