"""The model run forward: the motion that an effort makes, alone or under the rig's controller.

Effects are named in the effort, where a controller cannot hide them; this shows what they are worth
in the motion.

axis.py    a rig's axis, ready to be run by the effort that acted
torque.py  its torque, compiled, and its steps in time
Here: a prediction, and how far it is from the measured motion, from measured states on
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from spirob.identify.intervals import score_interval
from spirob.machine.forward.axis import Axis, BodyTable, drive_reading, logged
from spirob.machine.inverse.motion import Motion
from spirob.machine.inverse.problem import InverseProblem

WINDOW = 0.5  # s, of a short horizon that starts again from the measured motion
ROWS = {"position": "q", "speed": "v"}  # of a prediction -> of the motion


@dataclass(frozen=True)
class Prediction:
    """The motion that a model predicts along all pieces of one role, NaN where it does not.

    motion  the measured one;  long  (3, n) position, speed, effort from the start of each piece
    short   (3, n) the same where every half second begins anew; None under a controller
    """

    motion: Motion
    long: np.ndarray
    short: np.ndarray | None


class Forward:
    """Runs the models of a rig forward on the trials of one role."""

    def __init__(self, problem: InverseProblem):
        self.problem = problem
        self._body = BodyTable(problem) if problem.body else None
        self._long, self._short = horizons(problem, np.inf), horizons(problem, WINDOW)
        self._controlled = problem.rig.predict == "closed_loop"

    def absent(self, changes: Mapping[str, float]) -> str:
        """Why this model cannot be run forward; empty where it can."""
        if self._body and self._body.reason:
            return self._body.reason
        if self.problem.logs.about:
            return "logs with numbers of their own are not run forward"
        if self.problem.rig.position and self.problem.rig.position.side == "load":
            return "the motor's motion behind a sensor at the load is not measured"
        if self._axis(changes).least_inertia > 0.0:
            return ""
        return "without inertia the speed does not follow from a balance"

    def predicted(self, changes: Mapping[str, float]) -> Prediction:
        """What the rig asks to be predicted: under the measured effort, or under its controller."""
        axis = self._axis(changes)
        if self._controlled:
            return Prediction(axis.motion, axis.run(self._long, self._goal(), self._gains()), None)
        given = drive_reading(self.problem.asked, axis.p)
        return Prediction(axis.motion, axis.run(self._long, given), axis.run(self._short, given))

    def missed(self, changes: Mapping[str, float]) -> float:
        """Mean squared error of the speed within half seconds, under the measured effort."""
        axis = self._axis(changes)
        _, v, _ = axis.run(self._short, drive_reading(self.problem.asked, axis.p))
        return float(np.nanmean((v - axis.motion.v) ** 2))

    def errors(self, changes: Mapping[str, float], found: Prediction) -> dict[str, Any]:
        """RMS errors of a prediction with 95 % intervals.

        window  of half-second horizons, as drawn again;  whole  from the start of each piece, whole
        pieces drawn again, because such an error grows and no half second of it is like another
        effort  under a controller, whose errors do not grow: there half seconds are drawn
        """
        out: dict[str, Any] = {"window": None, "effort": None}
        out["whole"] = motion_errors(found.motion, found.long, self._blocks)
        if found.short is not None:
            out["window"] = motion_errors(found.motion, found.short, self._windows)
            return out
        problem, p = self.problem, self.problem.table.vector(changes)
        # before and after the horizon nothing was asked for, and filters need something there
        effort = np.where(np.isnan(found.long[2]), found.motion.effort, found.long[2])
        asked = problem.filtered(logged(problem.asked, p, effort))
        out["effort"] = error(problem.measured(), asked, problem.thinned(self._windows))
        return out

    def guessed(self) -> dict[str, dict[str, Any]]:
        """The errors of guesses that need no model, by their names."""
        motion = self.problem.asked.motion
        long, short = guesses(motion, self._long), guesses(motion, self._short)
        found: dict[str, dict[str, Any]] = {}
        for name, whole in long.items():
            window = motion_errors(motion, short[name], self._windows)
            found[name] = {
                "window": None if self._controlled else window,
                "whole": motion_errors(motion, whole, self._blocks),
                "effort": None,
            }
        return found

    @property
    def _windows(self) -> np.ndarray:
        return numbered(self._short, len(self.problem.asked.motion.q))

    @property
    def _blocks(self) -> np.ndarray:
        """What is drawn again of a whole log."""
        if self._controlled:
            return self._windows
        return numbered(self._long, len(self.problem.asked.motion.q))

    def _axis(self, changes: Mapping[str, float]) -> Axis:
        return Axis(self.problem, self._body, changes)

    def _goal(self) -> np.ndarray:
        references = [p.reference for r in self.problem.recordings for p in r.pieces]
        return np.concatenate([r for r in references if r is not None])

    def _gains(self) -> list[float]:
        rig = self.problem.rig
        control = rig.control
        assert control is not None
        factor = rig.effort.scale
        limit = np.inf if control.limit is None else control.limit * factor
        return [1.0, *control.gains, factor, limit]


def motion_errors(
    motion: Motion, predicted: np.ndarray, blocks: np.ndarray
) -> dict[str, dict[str, Any]]:
    """ "position" and "speed": their RMS error and its 95 % interval, in SI.

    predicted  (≥ 2, n), NaN where nothing was predicted;  blocks (n,), in which errors go together
    """
    return {
        name: error(getattr(motion, field), predicted[k], blocks)
        for k, (name, field) in enumerate(ROWS.items())
    }


def error(measured: np.ndarray, predicted: np.ndarray, blocks: np.ndarray) -> dict[str, Any]:
    """RMS error and its interval over the rows that were predicted; [null, null] in one block."""
    rows = ~np.isnan(predicted)
    missed = predicted[rows] - measured[rows]
    found = score_interval(measured[rows], predicted[rows], blocks[rows])
    return {"rmse": float(np.sqrt(np.mean(missed**2))), "interval": found["rmse"]}


def guesses(motion: Motion, segments: np.ndarray) -> Mapping[str, np.ndarray]:
    """What nobody needs a model for, over the same segments, (2, n) each, NaN elsewhere.

    "standing still" where the segment begins, "keeping the speed" that it begins with
    """
    still, kept = np.full((2, len(motion.q)), np.nan), np.full((2, len(motion.q)), np.nan)
    for _, first, last in segments:
        rows, v = slice(first, last), motion.v[first]
        still[:, rows] = np.array([[motion.q[first]], [0.0]])
        kept[0, rows] = motion.q[first] + v * (motion.seconds[rows] - motion.seconds[first])
        kept[1, rows] = v
    return {"standing still": still, "keeping the speed": kept}


def numbered(segments: np.ndarray, count: int) -> np.ndarray:
    """The number of the segment in which each of `count` rows lies, (count,)."""
    found = np.zeros(count, dtype=int)
    for k, (_, first, last) in enumerate(segments):
        found[first:last] = k
    return found


def horizons(problem: InverseProblem, length: float) -> np.ndarray:
    """Row where its piece begins, first row and the one behind the last of each horizon, (s, 3).

    length  of a horizon [s];  infinite: one for each piece

    Horizons lie end to end from the first to the last row of a piece that is compared, so over what
    is left out in between (a hold, a saturated drive) as well: the axis moved there, too.
    """
    found = []
    motion, k = problem.asked.motion, 0
    for recording in problem.recordings:
        for piece in recording.pieces:
            begin, used = int(motion.starts[k]), np.flatnonzero(piece.use)
            k += 1
            if len(used) < 2:
                continue
            first, end = begin + int(used[0]), begin + int(used[-1]) + 1
            rows = max(2, int(min(np.round(length / recording.period), end - first)))
            # a last row alone would be compared with itself
            found += [(begin, r, min(end, r + rows)) for r in range(first, end - 1, rows)]
    return np.array(found, dtype=int).reshape(-1, 3)
