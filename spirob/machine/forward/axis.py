"""A rig's axis with the effects of one model, ready to be run."""

from collections.abc import Mapping, Sequence

import numpy as np

from spirob.machine.asked import ADDED, BEFORE, HINGE
from spirob.machine.forward.body_table import BodyTable
from spirob.machine.forward.steps import loop_of
from spirob.machine.forward.torque import AT, OWN, memory_of
from spirob.machine.inverse import InverseProblem
from spirob.machine.motion import Motion

# of effects within the loop
PORTS = ("sensing.current", *BEFORE, "winch.efficiency", HINGE, *ADDED)


class Axis:
    """One axis; `motion` is the measured one, without the errors that the model holds in it."""

    def __init__(
        self, problem: InverseProblem, body: BodyTable | None, changes: Mapping[str, float]
    ):
        self.problem, self.p = problem, problem.table.vector(changes)
        self.motion: Motion = problem.asked.seen(self.p)
        self._effects = [e for port in PORTS for e in problem.asked.present(port, self.p)]
        signals = {signal for e in self._effects for signal in e.reads.values()}
        weighed = any(signal.startswith("hinge.weight") for signal in signals)
        tip = problem.asked.tip_mass(self.p)
        self.table = body.of(tip, weighed) if body else np.zeros((1, 0, len(AT)))
        self._grid = body.grid if body else np.ones(2)
        self._where = body.where if body else np.zeros(len(self.motion.q))

    def run(
        self, segments: np.ndarray, given: np.ndarray, control: Sequence[float] = (0.0,) * 8
    ) -> np.ndarray:
        """Position, speed and effort along all pieces, (3, n), NaN where no segment lies.

        segments, given, control  as `steps.loop_of` says
        """
        motion = self.motion
        out = np.full((3, len(motion.q)), np.nan)
        seen = [motion.seconds, motion.q, motion.v, motion.a, motion.effort, self._where]
        loop_of(self._effects)(
            out,
            segments,
            motion.steps[np.searchsorted(motion.starts, segments[:, 0], "right") - 1],
            np.array(seen),
            given,
            np.array(control, float),
            self._own(),
            np.array(self._numbers(), float),
            np.array(memory_of(self._effects)),
            self.table,
            self._grid,
        )
        return out

    @property
    def least_inertia(self) -> float:
        """Smallest inertia that is moved anywhere [kg·m² or kg, in units of effort]."""
        own = float(self._own()[OWN.index("INERTIA")])
        body = self.table[:, :, AT.index("MASS")]
        return own + float(np.min(body)) if body.size else own

    def _own(self) -> np.ndarray:
        problem, get = self.problem, self.problem.table.position
        cells = {"REST": problem.rest_speed, "ANGLE": problem.sizes.angle}
        cells["HINGE"] = problem.body.stiffness if problem.body else 0.0
        return np.array(
            [cells[x] if x in cells else self.p[get(f"rig.{x.lower()}")] for x in OWN], float
        )

    def _numbers(self) -> list[float]:
        asked = self.problem.asked
        return [x for e in self._effects for x in asked.values(e, self.p).values()]
