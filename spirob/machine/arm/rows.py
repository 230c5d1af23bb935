"""What of an arm's logs is compared: which logs in which role, which blocks, which cycles of them.

The arm's state in the midst of a log is not in the log, so the model plays a log from rest: all
that comes before a block is played, too, but counts for nothing.

A row that is left out counts in no signal of its trial: both motors pull at one arm, and a current
that one of them lacks is missing in what the other has to hold.

An arm of point hinges between two taut tendons buckles: hinges snap from one side to the other, and
which of them does so when, the scatter from hinge to hinge decides, of which nobody knows.  So each
trial is played with the hinges of some builds, stiffness and damping drawn hinge by hinge, and a
cycle counts only where these plays are apart by no more than a model is said to be complete within.
Nothing of what was measured takes part, so a held-out log stays held out.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from spirob.errors import DataError, SimulationError, TooShort
from spirob.identify.builds import hinges
from spirob.identify.measurement import Measurement
from spirob.identify.residual import BLOCK, STILL, Residual
from spirob.machine.arm.description import ArmFile
from spirob.machine.recordings import checks
from spirob.machine.recordings.checks import widened
from spirob.machine.recordings.rests import LEAST
from spirob.machine.recordings.saturation import FULL
from spirob.machine.recordings.selection import KEPT, SHORTEST_DIVIDED
from spirob.robot import MOTORS

CYCLE = 1e-3  # s, of the model
HOLD = 0.1  # s that a motor stands at least; a reversal is shorter, and says much of friction
NOISE = 5.0  # times `STILL` that the noise of a derivative may reach while it stands
STANDS = "where the working motor stands"
CHOOSING = 0.2  # of a log that is the only one to fit: it chooses between effects


@dataclass(frozen=True)
class Part:
    """A part of a log, called by its number, from one share of its length up to another."""

    log: int
    begin: float = 0.0
    end: float = 1.0

    @property
    def whole(self) -> bool:
        """No block of it, but all."""
        return (self.begin, self.end) == (0.0, 1.0)


def roles(train: Sequence[int], test: Sequence[int]) -> tuple[dict[str, list[Part]], list[str]]:
    """Parts of logs by role, and sentences that say where a log was divided.

    The last third of the training logs chooses between effects; of a single one its last block
    does.  Where nothing is held out the end of each training log is.
    """
    end = 1.0 if test else 1.0 - KEPT
    said = []
    if len(train) > 1:
        cut = len(train) - max(1, len(train) // 3)
        fitted = [Part(log, 0.0, end) for log in train[:cut]]
        choosing = [Part(log, 0.0, end) for log in train[cut:]]
    else:
        between = end - CHOOSING
        fitted = [Part(log, 0.0, between) for log in train]
        choosing = [Part(log, between, end) for log in train]
        said.append(
            f"One training log was given: {between:.0%} of it are fitted, the next {CHOOSING:.0%} "
            "choose between effects."
        )
    held = [Part(log) for log in test] or [Part(log, end, 1.0) for log in train]
    if not test:
        said.append(
            f"No held-out log was given: the last {KEPT:.0%} of each training log was kept aside."
        )
    if said:
        said.append("Blocks of one trial share its start, load and temperature.")
    return {"train": fitted, "validate": choosing, "heldout": held}, said


def block(trial: Measurement, part: Part) -> Measurement:
    """The trial up to the end of its part; what comes before the part is not compared.

    Raises TooShort where a log that is to be divided is shorter than 4 s, DataError where less
    than half a second of the part is compared.
    """
    cycles = len(trial.current)
    if part.whole:
        return trial
    if cycles < 1e3 * SHORTEST_DIVIDED:
        raise TooShort(
            trial.name, cycles, round(1e3 * SHORTEST_DIVIDED), "a log that is to be divided"
        )
    begin, end = round(part.begin * cycles), round(part.end * cycles)
    part_of_it = replace(
        trial.until(end),
        name=f"{trial.name} ({100 * part.begin:.0f} to {100 * part.end:.0f} %)",
    )
    return replace(part_of_it, use=_from(part_of_it, begin))


def _from(trial: Measurement, begin: int) -> np.ndarray | None:
    if begin == 0:
        return trial.use
    cycles = len(trial.current)
    use = np.ones(cycles, bool) if trial.use is None else trial.use.copy()
    use[:begin] = False
    if 1e-3 * np.count_nonzero(use) < BLOCK:
        raise DataError(
            f"{trial.name}: of its part from {1e-3 * begin:.3g} to {1e-3 * cycles:.3g} s less "
            f"than {BLOCK:g} s are left after the row filters"
        )
    return use


def usable(
    name: str,
    current: np.ndarray,
    velocity: np.ndarray,
    moves: int,
    rig: ArmFile,
    said: list[str],
) -> np.ndarray | None:
    """Cycles that are compared, (T,); None where none is left out.

    current   unfiltered [A], (T, 2);  velocity  filtered [m/s], (T, 2)
    moves     the motor that does the work, whose speed counts
    said      gets a sentence for each reason

    Raises DataError where less than a second is left.
    """
    use, lost = np.ones(len(current), bool), []
    if rig.filter.drop:
        use[: rig.filter.drop] = use[-rig.filter.drop :] = False
    for out, why in _left_out(current, velocity[:, moves], MOTORS[moves], rig):
        if why == STANDS and np.count_nonzero(use & ~out) < LEAST * np.count_nonzero(use):
            said.append(f"{name}: the working motor stands most of the time.")
        elif out.any():
            use &= ~out
            lost.append(f"{out.mean():.1%} of the rows left out, {why}")
    checks.enough(name, CYCLE * np.count_nonzero(use), "; ".join(lost))
    said += [f"{name}: {text}." for text in lost]
    return None if use.all() else use


def _left_out(
    current: np.ndarray, v: np.ndarray, working: str, rig: ArmFile
) -> Iterator[tuple[np.ndarray, str]]:
    """Cycles that do not count, (T,), and why; v is the speed of the working motor [m/s]."""
    reach = round(0.5 / (rig.filter.cutoff * CYCLE))  # the filter smears what is beside a row
    for m, (motor, columns) in enumerate(rig.motors().items()):
        if columns.effort.limit is not None:
            limit = columns.effort.limit * columns.amperes(columns.effort)
            full = np.abs(current[:, m]) >= FULL * limit
            yield widened(full, reach), f"where the drive of the {motor} motor saturates"
    speed = np.abs(v) / rig.motors()[working].metres(rig.machine())
    if rig.rows.minimum_speed is not None:
        yield speed < rig.rows.minimum_speed, "as too slow"
    elif rig.rows.standstill == "drop":
        yield holds(v), STANDS
    if rig.rows.maximum_speed is not None:
        yield speed > rig.rows.maximum_speed, "as too fast"


def holds(v: np.ndarray) -> np.ndarray:
    """Cycles of a speed (T,) [m/s] that belong to a standstill of at least `HOLD`, (T,)."""
    window = round(HOLD / CYCLE)
    still = np.abs(uniform_filter1d(v, window)) < STILL
    still &= np.abs(v) < NOISE * STILL
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]])))
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        if stop - start < window:
            still[start:stop] = False
    return still


BUILDS = 8
TOLD = 0.1  # s; a trial with less of it says nothing, and is left out whole
LEAST_TIME = (
    1.0  # s of all logs of a role that count in any case, those that builds leave least open
)


def determined(
    residual: Residual, changes: Mapping[str, float], limit: float
) -> tuple[list[Measurement], float]:
    """The trials without what builds leave open, and the share of their cycles that counts.

    changes  the numbers at which they are played
    limit    by how much builds may be apart, RMS [A]
    """
    apart = [spread(residual, changes, k) for k in range(len(residual.trials))]
    used = [
        np.ones(len(a), bool) if t.use is None else t.use
        for a, t in zip(apart, residual.trials, strict=True)
    ]
    every = np.sort(np.concatenate([a[use] for a, use in zip(apart, used, strict=True)]))
    limit = max(limit, float(every[min(len(every), round(1e3 * LEAST_TIME)) - 1]))
    kept = [use & (a <= limit) for a, use in zip(apart, used, strict=True)]
    counts = [int(np.count_nonzero(use)) for use in kept]
    trials = [
        replace(trial, use=use)
        for trial, use, count in zip(residual.trials, kept, counts, strict=True)
        if count >= min(max(counts), round(1e3 * TOLD))
    ]
    return trials, float(sum(counts) / len(every))


def spread(residual: Residual, changes: Mapping[str, float], index: int) -> np.ndarray:
    """RMS by which builds differ in a trial, cycle by cycle, (T,) [A].

    The larger of the working motor's current and of the other one's length, at the residual's
    weight; infinite from where a build cannot be played on.
    """
    whole = replace(residual, trials=[replace(residual.trials[index], use=None)])
    whole = replace(whole, filter=replace(residual.filter, every=1))
    cycles, units = len(whole.trials[0].current), residual.plant.rig.units
    rng, total = np.random.default_rng(0), np.zeros(cycles)
    middle = _signals(whole, changes)
    for _ in range(BUILDS):
        build = replace(whole, plant=residual.plant.scattered(hinges(rng, units)))
        try:
            total += np.max((_signals(build, changes) - middle) ** 2, axis=0)
        except SimulationError:
            return np.full(cycles, np.inf)
    return np.sqrt(total / BUILDS)


def _signals(residual: Residual, changes: Mapping[str, float]) -> np.ndarray:
    """Model minus measurement of one trial, a row for each signal that counts, (signals, T) [A]."""
    trial = residual.trials[0]
    signals = residual.one(changes, 0).reshape(-1, len(trial.current))
    return signals[: 2 * len(residual.driven(trial))]
