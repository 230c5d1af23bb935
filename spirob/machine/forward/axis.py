"""A rig's axis, ready to be run by the effort that acted, and its body as a table.

    F(q, v, a) = M(q)·a + g(q) + d(q)·v + c(q)·v² + dry(q)·sign(v)

F is what inverse dynamics asks of the drive, and five motions at each position give the five terms:
so whatever the model file holds (springs, dampers, armature, dry friction, a tendon's lever and its
change with the joint) counts here as it does there.  Other joints move as they were measured: with
them F changes along the log, the table has rows along it, and d holds their Coriolis forces.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from spirob.machine.forward.torque import AT, OWN, loop_of, memory_of
from spirob.machine.inverse.body import RigidBody
from spirob.machine.inverse.equations import ADDED, BEFORE, HINGE, AskedEffort
from spirob.machine.inverse.motion import Motion, late
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.recordings.recording import Piece

NODES, NODES_BESIDE = 257, 33  # positions at least; fewer where each of them has many rows
DENSE, DENSE_BESIDE = 0.05, 0.15  # rad or m between them at most, as some joints turn round
MOST = 2**14  # positions; a joint that turns farther in a log is a wheel
WIDER, WIDER_BESIDE = 1.0, 0.5  # of the stroke, on either side; beyond, forces are those of the end
FINE = 6.0  # rows in a period of the log's cutoff, where other joints move
FAST = 1e3  # times the usual speed, where dry friction is all there
ALIKE = 1e-3  # of the largest force, by which a table may miss one


class BodyTable:
    """What AT names of a body, at the positions that a problem's logs reach.

    grid   (2,) first position and the distance to the next
    where  (n,) row of the table for each row of the log, with a fraction
    """

    def __init__(self, problem: InverseProblem):
        assert problem.body is not None
        self._body: RigidBody = problem.body
        self._mass, self._motion = problem.sizes.mass, problem.asked.motion
        self._beside = bool(self._body.body.joints)
        self._pieces = [(r, p) for r in problem.recordings for p in r.pieces]
        q = self._motion.q
        wider = (WIDER_BESIDE if self._beside else WIDER) * float(np.ptp(q))
        low, high = self._body.range
        low, high = max(low, float(q.min()) - wider), min(high, float(q.max()) + wider)
        least, far = (NODES_BESIDE, DENSE_BESIDE) if self._beside else (NODES, DENSE)
        self._nodes = np.linspace(low, high, min(MOST, max(least, int((high - low) / far))))
        self.grid = np.array([low, self._nodes[1] - self._nodes[0]])
        self.where, self._rows = self._placed()

    def of(self, tip: float, weighed: bool) -> np.ndarray:
        """The table with a mass at the tip [kg], (rows, nodes, AT); weights only where wanted."""
        table = self._own.copy()
        if tip:
            table += tip / self._mass * self._payload
        if weighed:
            found = self._body.weights(self._moving(0.0, 0.0))
            for name in ("along", "across"):
                table[:, :, AT.index(name.upper())] = found[name].reshape(table.shape[:2])
        return table

    @cached_property
    def reason(self) -> str:
        """Why this body cannot be run forward; empty where it can."""
        v, a = 0.7 * self._speeds[0], -0.4 * self._speeds[1]
        with self._body.without_dry_friction():
            asked = self._body.load(self._moving(v, a))
        told = self._own[:, :, :4] @ np.array([a, 1.0, v, v**2])
        if np.max(np.abs(asked - told.ravel())) < ALIKE * np.max(np.abs(asked)):
            return ""
        return (
            f"what {self._body.body.mjcf} asks for is not of the form M·a + g + d·v + c·v², as "
            "with a fluid around it or equalities between its joints"
        )

    def _placed(self) -> tuple[np.ndarray, list[np.ndarray]]:
        """Row of the table at each row of the log, and the rows of each piece that have one."""
        if not self._beside:
            return np.zeros(len(self._motion.q)), [np.array([0])]
        where, kept, count = [], [], 0
        for recording, piece in self._pieces:
            last = len(piece.q) - 1
            every = max(1, int(1.0 / (FINE * recording.cutoff * recording.period)))
            rows = np.unique([*range(0, last, every), last])
            where.append(count + np.interp(np.arange(last + 1), rows, np.arange(len(rows))))
            kept.append(rows)
            count += len(rows)
        return np.concatenate(where), kept

    def _moving(self, v: float, a: float) -> Piece:
        """Every position of the table at one speed and acceleration; other joints as measured."""
        others = {}
        for name in self._body.body.joints:
            pairs = zip(self._pieces, self._rows, strict=True)
            along = np.concatenate([piece.others[name][rows] for (_, piece), rows in pairs])
            others[name] = np.repeat(along, len(self._nodes), axis=0)
        q = np.tile(self._nodes, sum(len(rows) for rows in self._rows))
        nothing = np.zeros_like(q)
        speed, rate = np.full_like(q, v), np.full_like(q, a)
        motion = nothing, q, q, speed, rate
        return Piece(*motion, nothing, nothing, nothing, nothing, others=others)

    @cached_property
    def _speeds(self) -> tuple[float, float]:
        """A usual speed and acceleration, which set the size of the differences."""
        return float(np.max(np.abs(self._motion.v))), float(np.max(np.abs(self._motion.a)))

    @cached_property
    def _own(self) -> np.ndarray:
        with self._body.without_dry_friction():
            table = self._terms(self._body.load)
        if self._body.rubs:
            table[:, :, AT.index("DRY")] = self._dry().reshape(table.shape[:2])
        return table

    @cached_property
    def _payload(self) -> np.ndarray:
        def added(piece: Piece) -> np.ndarray:
            return self._body.payload(piece, self._mass, self._body.load(piece))

        with self._body.without_dry_friction():
            return self._terms(added)

    def _terms(self, force: Callable[[Piece], np.ndarray]) -> np.ndarray:
        """The table of a force that is linear in the acceleration and quadratic in the speed."""
        v, a = self._speeds
        still, fast = force(self._moving(0.0, 0.0)), force(self._moving(v, 0.0))
        back, pushed = force(self._moving(-v, 0.0)), force(self._moving(0.0, a))
        table = np.zeros((len(still), len(AT)))
        table[:, AT.index("MASS")] = (pushed - still) / a
        table[:, AT.index("STANDING")] = still
        table[:, AT.index("LINEAR")] = (fast - back) / (2.0 * v)
        table[:, AT.index("SQUARE")] = (fast + back - 2.0 * still) / (2.0 * v**2)
        return table.reshape(-1, len(self._nodes), len(AT))

    def _dry(self) -> np.ndarray:
        """Level of the dry friction, from both directions at a speed where it is all there."""
        ways = [self._moving(sign * FAST * self._speeds[0], 0.0) for sign in (1.0, -1.0)]
        rubbed = [self._body.load(way) for way in ways]
        with self._body.without_dry_friction():
            free = [self._body.load(way) for way in ways]
        return 0.5 * (rubbed[0] - free[0] - rubbed[1] + free[1])


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
        self, segments: np.ndarray, given: np.ndarray, control: Sequence[float] = (0.0,) * 9
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
        cells["LOAD"] = 0.0 if problem.body else self.p[get("rig.inertia")]
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
    longer = replace(motion, starts=np.array(starts), q=motion.q[index], follows=())
    seen = {name: x[index] for name, x in asked.signals(motion, np.zeros_like(effort), p).items()}
    found = effort[index]
    for effect in asked.present("sensing.report", p):
        found = asked.run(effect, p, longer, seen | {"motor.current": found}, found)
    long = np.diff(motion.starts)
    kept = [found[b - n : b] for n, b in zip(long, starts[1:], strict=True)]
    return np.concatenate(kept)
