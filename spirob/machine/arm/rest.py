"""Under which currents the arm rests as a log begins: read from its first samples, then fitted.

Lengths count from where a log begins.  Two currents hold the arm there; where they are wrong by a
milliampere, the arm stands elsewhere for the whole log, and all that the working motor is asked for
is off by about as much.  The first samples tell them to their noise over the root of their number,
and the whole log tells them better.  So they are fitted, log by log, held-out ones too, as numbers
that are known to what the first samples leave open.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual
from spirob.robot import MOTORS

BEGUN = 50  # cycles of 1 ms at the beginning, for which the arm has to stand
RESTED = 1000  # for how many it is asked how long it stands
STILL = 0.02  # of the fast part of the motion: so slow it stands yet
STEADY = 1e-3  # of a current, by which it may drift without noise
FIRST = 3  # samples, of which fewer may hold any part of a change
SURE = 3.0  # deviations of a mean, beyond which it is another
APART = 5  # samples, between which noise has nothing in common at 200 Hz and more
FOLLOWING = 2 * APART  # samples that say where a current goes


def rests(velocity: np.ndarray) -> int:
    """Cycles for which the arm stands as the log begins, of `RESTED`; velocity (T, 2)."""
    slow = STILL * np.quantile(np.abs(velocity), 0.95)
    moves = np.any(np.abs(velocity[:RESTED]) > slow, axis=1)
    stood = int(np.argmax(moves)) if moves.any() else len(moves)
    return max(BEGUN, stood)


def held(first: np.ndarray) -> tuple[np.ndarray, np.ndarray] | tuple[None, None]:
    """Currents under which the arm rests as a log begins, and what each may be off by, (2,) [A].

    None where there are none.

    first  samples of both currents while the arm stands, (n, 2)
    """
    levels, widths = np.array([first_level(current) for current in first.T]).T
    return (levels, widths) if levels.any() else (None, None)


def first_level(current: np.ndarray) -> tuple[float, float]:
    """Where a current, (n,), begins, and how far that may be off.

    0 where its first samples cannot be told from their noise.  It may be asked to change at once.
    So the mean reaches only as far as it agrees, within what the noise allows, with the means of
    fewer samples; a change begins before it shows, so where one does, over half of these.  What
    the noise allows is what may be missed.  Samples too few for that may hold any part of the
    change, and say nothing where it goes to 0.
    """
    bend = current[2 * APART :] - 2.0 * current[APART:-APART] + current[: -2 * APART]  # no ramp
    noise = 1.4826 * np.median(np.abs(bend - np.median(bend))) / np.sqrt(6)
    count = _unchanged(current, noise)
    if any(_is_zero(current[:n], noise) for n in (min(FIRST, count), count)):
        return 0.0, 0.0
    if count >= FIRST:
        return _mean(current[: count if count == len(current) else max(FIRST, count // 2)], noise)
    first, after = current[:count], current[count : count + FOLLOWING]
    if _is_zero(after, noise):
        return 0.0, 0.0
    level, width = _mean(first, noise)
    return level, max(width, abs(float(np.mean(after)) - level))


def _unchanged(current: np.ndarray, noise: float) -> int:
    """Samples before a current is seen to change; all where it is not.

    The mean over a change hides it for a while; so the very first ones are compared with what
    follows them.
    """
    for count in range(1, FIRST):
        (before, one), (after, other) = (
            _mean(part, noise) for part in (current[:count], current[count : count + FOLLOWING])
        )
        if abs(after - before) > one + other:
            return count
    counts = np.arange(1, len(current) + 1)
    means = np.cumsum(current) / counts
    widths = np.maximum(SURE * noise / np.sqrt(counts), STEADY * np.abs(means))
    agree = np.maximum.accumulate(means - widths) <= np.minimum.accumulate(means + widths)
    return len(agree) if agree.all() else int(np.argmin(agree))


def _mean(samples: np.ndarray, noise: float) -> tuple[float, float]:
    """Their mean, and what it may be off by."""
    mean = float(np.mean(samples))
    return mean, max(SURE * noise / len(samples) ** 0.5, STEADY * abs(mean))


def _is_zero(samples: np.ndarray, noise: float) -> bool:
    mean, width = _mean(samples, noise)
    return abs(mean) <= width


def is_unsure(of: Residual) -> bool:
    """Whether one of the logs begins under currents that are not known exactly."""
    return any(trial.unsure is not None for trial in of.trials)


def rested(of: Residual, changes: Mapping[str, float], read: Residual) -> Residual:
    """The same trials from where the arm rests under the currents that suit these numbers best.

    What those that were `read` may be off by is one deviation.  A log weighs against it by what it
    misses, and by no more samples than it has half seconds, over which that is correlated: a log
    that misses much moves them little.
    """
    if not is_unsure(of):
        return of
    missed = of(changes)
    slopes = np.column_stack([_moved(of, m)(changes) - missed for m in range(len(MOTORS))])
    trials = []
    for k, (trial, first) in enumerate(zip(of.trials, read.trials, strict=True)):
        own = np.arange(of.edges[k], of.edges[k + 1])
        own = own[of.rows[own]]
        told = len(own) > 0
        trials.append(_stepped(trial, first, missed[own], slopes[own], of.block) if told else trial)
    return replace(of, trials=trials)


def _moved(of: Residual, motor: int) -> Residual:
    """With the current of one motor at the beginning off by a deviation."""
    step = np.eye(len(MOTORS))[motor]
    return replace(of, trials=[_held_by(trial, step) for trial in of.trials])


def _stepped(
    trial: Measurement, read: Measurement, missed: np.ndarray, slopes: np.ndarray, block: int
) -> Measurement:
    """The trial from the best beginning.

    missed  (n,), and its slopes by deviations, (n, 2);  block  samples in half a second
    """
    weight, size = max(block, 1) ** -0.5, float(np.sqrt(np.mean(missed**2)))
    known = np.vstack([weight * slopes, size * np.eye(slopes.shape[1])])
    asked = np.concatenate([weight * missed, size * _off(trial, read)])
    return _held_by(trial, -np.linalg.lstsq(known, asked)[0])


def _off(trial: Measurement, read: Measurement) -> np.ndarray:
    """By how many deviations the currents at the beginning are off what was read, (2,)."""
    now, before = trial.schedule.held, read.schedule.held
    off = np.zeros(len(MOTORS))
    if now is not None and before is not None and trial.unsure is not None:
        np.divide(now - before, trial.unsure, out=off, where=trial.unsure > 0.0)
    return off


def _held_by(trial: Measurement, deviations: np.ndarray) -> Measurement:
    """The trial with its currents at the beginning moved by so many deviations."""
    if trial.schedule.held is None or trial.unsure is None:
        return trial
    moved = trial.schedule.held + deviations * trial.unsure
    return replace(trial, schedule=replace(trial.schedule, held=moved))
