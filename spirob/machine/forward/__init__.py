"""The model run forward: the motion that an effort makes, alone or under the rig's controller.

Effects are named in the effort, where a controller cannot hide them; this shows what they are worth
in the motion.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from spirob.machine.asked import ADDED, BEFORE, READ
from spirob.machine.forward.steps import loop_of
from spirob.machine.forward.torque import OWN, memory_of
from spirob.machine.inverse import InverseProblem
from spirob.machine.rig import EFFORTS

WINDOW = 0.5  # s, of a short horizon that starts again from the measured motion


@dataclass(frozen=True)
class Motion:
    """Errors of a simulated motion on one role's trials; position in the axis' SI unit.

    window  RMS error of position over half-second horizons;  whole  from the start of each piece
    effort  RMS error of the effort that the controller asked for; None without a controller
    """

    window: float | None
    whole: float
    effort: float | None

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers."""
        return {"window": self.window, "whole": self.whole, "effort": self.effort}


def possible(problem: InverseProblem, changes: Mapping[str, float]) -> str:
    """Why this rig cannot be run forward; empty where it can."""
    if not isinstance(problem.rig.body, str):
        return "a body from a model file is only inverted, not run forward"
    inertia = problem.table.vector(changes)[problem.table.position("rig.inertia")]
    return "" if inertia > 0.0 else "without inertia the speed does not follow from a balance"


def open_loop(problem: InverseProblem, changes: Mapping[str, float]) -> Motion:
    """Play the measured effort and compare the motion."""
    axis, motion = _Axis(problem, changes), problem.asked.motion
    given = axis.behind_sensor()
    short = axis.run(_segments(problem, WINDOW), given)[0] - motion.q
    long = axis.run(_segments(problem, np.inf), given)[0] - motion.q
    return Motion(_rms(short), _rms(long), None)


def closed_loop(problem: InverseProblem, changes: Mapping[str, float]) -> Motion:
    """Follow the logged reference under the rig's controller; compare motion and effort."""
    control = problem.rig.control
    assert control is not None
    factor = EFFORTS[problem.rig.effort.kind][problem.rig.effort.unit]
    limit = np.inf if control.limit is None else control.limit * factor
    gains = [1.0, control.position, control.velocity, control.integral, factor, limit]
    references = [p.reference for r in problem.recordings for p in r.pieces]
    goal = np.concatenate([r for r in references if r is not None])
    axis, motion = _Axis(problem, changes), problem.asked.motion
    q, _, effort = axis.run(_segments(problem, np.inf), goal, gains)
    wrong = problem.filtered(effort) - problem.measured()
    return Motion(None, _rms(q - motion.q), _rms(wrong))


class _Axis:
    """One axis with the effects that are not neutral."""

    def __init__(self, problem: InverseProblem, changes: Mapping[str, float]):
        self.problem, self._p = problem, problem.table.vector(changes)
        ports = [*BEFORE, "winch.efficiency", *ADDED]
        self._effects = [e for port in ports for e in problem.asked.present(port, self._p)]

    def behind_sensor(self) -> np.ndarray:
        """The effort itself, from its reading; a lag of milliseconds moves nothing to be seen."""
        asked, motion = self.problem.asked, self.problem.asked.motion
        effort = motion.effort
        for effect in (e for port in reversed(READ) for e in asked.present(port, self._p)):
            if not effect.state:
                effort = 2 * effort - asked.run(effect, self._p, motion, {}, effort)
        return effort

    def run(
        self, segments: np.ndarray, given: np.ndarray, control: list[float] | None = None
    ) -> np.ndarray:
        """Position, speed and effort along all pieces, (3, n), from the measured state of each."""
        problem, motion = self.problem, self.problem.asked.motion
        get = problem.table.position
        cells = {"REST": problem.rest_speed, "ANGLE": problem.sizes.angle}
        own = [cells[x] if x in cells else self._p[get(f"rig.{x.lower()}")] for x in OWN]
        numbers = [x for e in self._effects for x in problem.asked.values(e, self._p).values()]
        out = np.zeros((3, len(motion.q)))
        loop_of(self._effects)(
            out,
            segments,
            motion.steps[np.searchsorted(motion.starts, segments[:, 0], "right") - 1],
            np.array([motion.seconds, motion.q, motion.v, motion.a]),
            given,
            np.array(control or np.zeros(6)),
            np.array(own),
            np.array(numbers, float),
            np.array(memory_of(self._effects)),
        )
        return out


def _segments(problem: InverseProblem, length: float) -> np.ndarray:
    """First and last row of horizons of that many seconds, none across pieces, (s, 2)."""
    found = []
    motion = problem.asked.motion
    for k, step in enumerate(motion.steps):
        begin, end = int(motion.starts[k]), int(motion.starts[k + 1])
        rows = int(min(max(2, np.round(length / step)), end - begin))
        # a last row alone would be compared with itself
        found += [
            (row, min(end, row + rows)) for row in range(begin, max(end - 1, begin + 1), rows)
        ]
    return np.array(found)


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))
