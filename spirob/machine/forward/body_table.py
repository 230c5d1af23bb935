"""The body behind the motor as a table over the position, for running forward.

    F(q, v, a) = M(q)·a + g(q) + d(q)·v + c(q)·v² + dry(q)·sign(v)

F is what inverse dynamics asks of the drive, and five motions at each position give the five terms:
so whatever the model file holds (springs, dampers, armature, dry friction, a tendon's lever and its
change with the joint) counts here as it does there.  Other joints move as they were measured: with
them F changes along the log, the table has rows along it, and d holds their Coriolis forces.
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np

from spirob.machine.body import RigidBody
from spirob.machine.forward.torque import AT
from spirob.machine.inverse import InverseProblem
from spirob.machine.recording import Piece

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
        return Piece(nothing, q, speed, rate, nothing, nothing, nothing, others=others)

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
