"""The model run forward: the motion that an effort makes, alone or under the rig's controller.

Effects are named in the effort, where a controller cannot hide them; this shows what they are worth
in the motion.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from spirob.machine.forward.axis import Axis
from spirob.machine.forward.body_table import BodyTable
from spirob.machine.forward.effort import drive_reading, logged
from spirob.machine.forward.horizons import WINDOW, horizons
from spirob.machine.inverse import InverseProblem
from spirob.machine.rig import EFFORTS


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


class Forward:
    """Runs the models of a rig forward on the trials of one role."""

    def __init__(self, problem: InverseProblem):
        self.problem = problem
        self._body = BodyTable(problem) if problem.body else None

    def absent(self, changes: Mapping[str, float]) -> str:
        """Why this model cannot be run forward; empty where it can."""
        if self._body and self._body.reason:
            return self._body.reason
        if self._axis(changes).least_inertia > 0.0:
            return ""
        return "without inertia the speed does not follow from a balance"

    def open_loop(self, changes: Mapping[str, float]) -> Motion:
        """Play the measured effort and compare the motion."""
        problem = self.problem
        axis = self._axis(changes)
        given = drive_reading(problem.asked, axis.p)
        short = axis.run(horizons(problem, WINDOW), given)[0] - axis.motion.q
        long = axis.run(horizons(problem, np.inf), given)[0] - axis.motion.q
        return Motion(_rms(short), _rms(long), None)

    def closed_loop(self, changes: Mapping[str, float]) -> Motion:
        """Follow the logged reference under the rig's controller; compare motion and effort."""
        problem, control = self.problem, self.problem.rig.control
        assert control is not None
        factor = EFFORTS[problem.rig.effort.kind][problem.rig.effort.unit]
        limit = np.inf if control.limit is None else control.limit * factor
        gains = [1.0, control.position, control.velocity, control.integral, factor, limit]
        references = [p.reference for r in problem.recordings for p in r.pieces]
        goal = np.concatenate([r for r in references if r is not None])
        axis = self._axis(changes)
        q, _, effort = axis.run(horizons(problem, np.inf), goal, gains)
        # before and after the horizon nothing was asked for, and filters need something there
        effort = np.where(np.isnan(effort), axis.motion.effort, effort)
        wrong = problem.filtered(logged(problem.asked, axis.p, effort)) - problem.measured()
        return Motion(None, _rms(q - axis.motion.q), _rms(wrong))

    def _axis(self, changes: Mapping[str, float]) -> Axis:
        return Axis(self.problem, self._body, changes)


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.nanmean(values**2)))
