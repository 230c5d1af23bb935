"""The model run forward: the motion that an effort makes, alone or under the rig's controller.

    J·dv/dt = scale·P(e) - b·v - k·q + Σ τ_effects(q, v, ...),    dq/dt = v

Effects are named in the effort, where a controller cannot hide them; this shows what they are worth
in the motion.  Steps are linearly implicit in the speed, v' = v + h·T/(J - h·∂T/∂v), because dry
friction is stiff at standstill: halving the sample period changes nothing that is seen.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from spirob.effects import Effect
from spirob.machine.asked import ADDED, BEFORE, READ
from spirob.machine.inverse import InverseProblem
from spirob.machine.recording import Piece, Recording
from spirob.machine.rig import EFFORTS, NUMBERS

WINDOW = 0.5  # s, of a short horizon that starts again from the measured motion
NUDGE = 1e-3  # of the rest speed, for the derivative by speed
Effort = Callable[[int, float, float], float]


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
    short, long = [], []
    for recording, piece in _pieces(problem):
        axis = _Axis(problem, changes, recording.period)
        given = axis.behind_sensor(piece)

        def play(k: int, q: float, v: float, given: np.ndarray = given) -> float:
            return float(given[k])

        length = max(2, round(WINDOW / recording.period))
        for first in range(0, len(piece.q) - 1, length):
            last = min(len(piece.q), first + length)
            short.append(axis.run(piece, play, first, last)[0] - piece.q[first:last])
        long.append(axis.run(piece, play, 0, len(piece.q))[0] - piece.q)
    return Motion(_rms(short), _rms(long), None)


def closed_loop(problem: InverseProblem, changes: Mapping[str, float]) -> Motion:
    """Follow the logged reference under the rig's controller; compare motion and effort."""
    control = problem.rig.control
    assert control is not None
    factor = EFFORTS[problem.rig.effort.kind][problem.rig.effort.unit]
    limit = np.inf if control.limit is None else control.limit * factor
    moved, asked = [], []
    for recording, piece in _pieces(problem):
        axis = _Axis(problem, changes, recording.period)
        assert piece.reference is not None
        reference, total = piece.reference, [0.0]

        def play(
            k: int,
            q: float,
            v: float,
            reference: np.ndarray = reference,
            total: list[float] = total,
            period: float = recording.period,
        ) -> float:
            wrong = control.position * (reference[k] - q) - v
            total[0] += period * wrong
            effort = control.velocity * wrong + control.integral * total[0]
            return float(np.clip(factor * effort, -limit, limit))

        q, effort = axis.run(piece, play, 0, len(piece.q))
        moved.append(q - piece.q)
        smooth = recording.last(recording.smooth(effort)) - recording.last(piece.effort)
        asked.append(smooth[piece.use][:: recording.every])
    return Motion(None, _rms(moved), _rms(asked))


class _Axis:
    """One axis with the effects that are not neutral, interpreted step by step."""

    def __init__(self, problem: InverseProblem, changes: Mapping[str, float], period: float):
        self.problem, self.period = problem, period
        self._p = problem.table.vector(changes)
        get = problem.table.position
        self._own = {name: float(self._p[get(f"rig.{name}")]) for name in NUMBERS}
        self._nudge = NUDGE * problem.rest_speed
        self._added = [e for port in ADDED for e in problem.asked.present(port, self._p)]
        self._pipes = [e for port in BEFORE for e in problem.asked.present(port, self._p)]
        self._shares = problem.asked.present("winch.efficiency", self._p)
        self._values = {e: problem.asked.values(e, self._p) for e in problem.effects}

    def behind_sensor(self, piece: Piece) -> np.ndarray:
        """The effort itself, from its reading; a lag of milliseconds moves nothing to be seen."""
        effort = piece.effort
        asked = self.problem.asked
        for effect in (e for port in reversed(READ) for e in asked.present(port, self._p)):
            if not effect.state:
                values = self._values[effect]
                effort = np.array([2 * e - effect.kernel(upstream=e, **values) for e in effort])
        return effort

    def run(
        self, piece: Piece, effort_of: Effort, first: int, last: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Positions and efforts from row `first` to `last`, from the measured state there."""
        q, v = float(piece.q[first]), float(piece.v[first])
        memory = {e: dict(e.state) for e in [*self._added, *self._pipes, *self._shares]}
        positions, efforts = np.empty(last - first), np.empty(last - first)
        inertia, h, a = self._own["inertia"], self.period, 0.0
        for k in range(first, last):
            effort = effort_of(k, q, v)
            positions[k - first], efforts[k - first] = q, effort
            seconds = float(piece.seconds[k])
            here, following = self._torque(q, v, a, effort, seconds, memory)
            beside, _ = self._torque(q, v + self._nudge, a, effort, seconds, memory)
            slope = min(0.0, (beside - here) / self._nudge)
            a = here / (inertia - h * slope)
            v += h * a
            q += h * v
            memory = following
            if not abs(q) < 1e9:  # a wrong model may run away; its error is large enough then
                positions[k - first :], efforts[k - first :] = 1e9, 0.0
                break
        return positions, efforts

    def _torque(
        self,
        q: float,
        v: float,
        a: float,
        effort: float,
        seconds: float,
        memory: Mapping[type[Effect], Mapping[str, float]],
    ) -> tuple[float, dict[type[Effect], dict[str, float]]]:
        """Torque on the axis and the effects' next memory."""
        signals = {
            "time": seconds,
            "motor.rest_speed": self.problem.rest_speed,
            "motor.speed": v,
            "motor.angle": q / self.problem.sizes.angle,
            "motor.current": effort,
            "motor.command": effort,
            "motor.load_torque": self._own["inertia"] * a + self._own["stiffness"] * q,
        }
        following: dict[type[Effect], dict[str, float]] = {}

        def call(effect: type[Effect], upstream: float) -> float:
            given = {x: signals[s] for x, s in effect.reads.items()} | self._values[effect]
            given |= {**memory[effect], "upstream": upstream, "dt": self.period}
            out = effect.kernel(**{x: given[x] for x in effect.arguments()})
            if not effect.state:
                following[effect] = {}
                return float(out)
            following[effect] = dict(zip(effect.state, out[1:], strict=True))
            return float(out[0])

        passed = effort
        for effect in self._pipes:
            passed = call(effect, passed)
        share = 1.0
        for effect in self._shares:
            share = call(effect, share)
        torque = self._own["scale"] * share * passed
        torque -= self._own["viscous"] * v + self._own["stiffness"] * q
        return torque + sum(call(e, 0.0) for e in self._added), following


def _pieces(problem: InverseProblem) -> list[tuple[Recording, Piece]]:
    return [(r, p) for r in problem.recordings for p in r.pieces]


def _rms(parts: list[np.ndarray]) -> float:
    return float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))
