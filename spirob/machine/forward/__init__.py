"""The model run forward: the motion that an effort makes, alone or under the rig's controller.

Effects are named in the effort, where a controller cannot hide them; this shows what they are worth
in the motion.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from spirob.machine.forward.axis import Axis
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


def possible(problem: InverseProblem, changes: Mapping[str, float]) -> str:
    """Why this rig cannot be run forward; empty where it can."""
    if not isinstance(problem.rig.body, str):
        return "a body from a model file is only inverted, not run forward"
    inertia = problem.table.vector(changes)[problem.table.position("rig.inertia")]
    return "" if inertia > 0.0 else "without inertia the speed does not follow from a balance"


def open_loop(problem: InverseProblem, changes: Mapping[str, float]) -> Motion:
    """Play the measured effort and compare the motion."""
    axis = Axis(problem, changes)
    given = drive_reading(problem.asked, axis.p)
    short = axis.run(horizons(problem, WINDOW), given)[0] - axis.motion.q
    long = axis.run(horizons(problem, np.inf), given)[0] - axis.motion.q
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
    axis = Axis(problem, changes)
    q, _, effort = axis.run(horizons(problem, np.inf), goal, gains)
    # before and after the horizon nothing was asked for, and filters need something there
    effort = np.where(np.isnan(effort), axis.motion.effort, effort)
    wrong = problem.filtered(logged(problem.asked, axis.p, effort)) - problem.measured()
    return Motion(None, _rms(q - axis.motion.q), _rms(wrong))


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.nanmean(values**2)))
