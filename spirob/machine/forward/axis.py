"""A rig's axis with the effects of one model, ready to be run by the effort that acted."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from spirob.machine.forward.body_table import BodyTable
from spirob.machine.forward.steps import loop_of
from spirob.machine.forward.torque import AT, OWN, memory_of
from spirob.machine.inverse import InverseProblem
from spirob.machine.inverse_equations import ADDED, BEFORE, HINGE, AskedEffort
from spirob.machine.motion import Motion, late

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


PASSES = 10  # of the solution for the effort before its report
SETTLE = 0.5  # s in which a report comes to what it shows at the first row


def drive_reading(asked: AskedEffort, p: np.ndarray) -> np.ndarray:
    """The effort that the drive's own sensor saw at every row of the motion, (n,).

    Undone are the log's delay and what the model holds at `sensing.frame` and `sensing.report`;
    errors of the sensor itself are undone in the loop, as a controller meets them too.  Of a lag
    slow changes are restored: a fast one is noise by the time that it is reported.
    """
    measured = wanted = asked.motion.effort
    for effect in asked.present("sensing.frame", p):
        wanted = wanted - measured + asked.in_cycles(effect, p, asked.motion)
    delay = float(p[asked.table.position("rig.delay")])
    wanted = late(wanted, -delay, asked.motion)
    found = wanted
    if asked.present("sensing.report", p):
        for _ in range(PASSES):
            found = found + wanted - reported(asked, p, found)
    return found


def logged(asked: AskedEffort, p: np.ndarray, effort: np.ndarray) -> np.ndarray:
    """What the log would say of an effort that the drive's sensor sees, (n,)."""
    delay = float(p[asked.table.position("rig.delay")])
    return late(reported(asked, p, effort), delay, asked.motion)


def reported(asked: AskedEffort, p: np.ndarray, effort: np.ndarray) -> np.ndarray:
    """The effort as the drive reports it, (n,); before each piece it stood at its first value."""
    motion = asked.motion
    rows, starts = [], [0]
    for k, step in enumerate(motion.steps):
        own = np.arange(motion.starts[k], motion.starts[k + 1])
        rows.append(np.concatenate([np.full(round(SETTLE / step), own[0]), own]))
        starts.append(starts[-1] + len(rows[-1]))
    index = np.concatenate(rows)
    longer = replace(motion, starts=np.array(starts), q=motion.q[index])
    seen = {name: x[index] for name, x in asked.signals(motion, np.zeros_like(effort)).items()}
    found = effort[index]
    for effect in asked.present("sensing.report", p):
        found = asked.run(effect, p, longer, seen | {"motor.current": found}, found)
    long = np.diff(motion.starts)
    kept = [found[b - n : b] for n, b in zip(long, starts[1:], strict=True)]
    return np.concatenate(kept)
