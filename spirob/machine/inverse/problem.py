"""The inverse model of a rig on its trials: the effort asked for, compared with the measured one.

Measured and modelled effort pass the same filters; the equations are in `inverse_equations`.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spirob.effects import Effect
from spirob.identify.problem import Effort, Rotor, Stretch
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.body import RigidBody
from spirob.machine.inverse.equations import AskedEffort
from spirob.machine.inverse.motion import Kept, kept_rows, late, motion_of
from spirob.machine.inverse.numbers import NONE, LogNumbers, profiled, table_of
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.inverse.swings import Swings
from spirob.machine.recordings.recording import Filter, Recording
from spirob.parameter import Table

BLOCK = 0.5  # s, over which a residual is correlated at most

CALL = 4000  # samples whose equations take as long as all else of a call


@dataclass
class Work:
    """What the searches of a diagnosis have done, counted so that no clock decides when they end.

    samples  of all residuals that they asked for on training trials, each call counted as `CALL`
             samples more
    """

    samples: int = 0

    def add(self, rows: int) -> None:
        """One call over so many rows of the logs."""
        self.samples += CALL + rows


class InverseProblem:
    """Effort asked for minus effort measured, on the trials of one role; see `identify.problem`.

    sizes  of the rig, which set the effects' nominal numbers; shared by all roles
    logs   own numbers of all logs of the rig;  own  those that are fitted anew at every call,
           because these trials are the only ones that tell them
    asked  the equations of the inverse model over these trials
    held_out  whether they judge what others are fitted to
    work   that its residuals add to
    """

    workers = 1  # threads would wait for one another, whatever the length of the logs

    def __init__(
        self,
        rig: RigFile,
        body: RigidBody | None,
        recordings: Sequence[Recording],
        effects: Sequence[type[Effect]],
        sizes: Sizes,
        rest_speed: float,
        logs: LogNumbers = NONE,
        own: Sequence[str] = (),
        held_out: bool = False,
        work: Work | None = None,
    ):
        self.work = work or Work()
        self.logs, self.own = logs, list(own)
        self._held_out = held_out
        self.rig, self.body, self.sizes = rig, body, sizes
        self.recordings = list(recordings)
        self.effects, self.rest_speed = list(effects), rest_speed
        self._table = table_of(rig, effects, sizes, logs)
        motion = motion_of(self.recordings, body, sizes.mass)
        stiffness = body.stiffness if body else 0.0
        self.asked = AskedEffort(
            motion, effects, self._table, sizes, rest_speed, stiffness, body is not None, held_out
        )
        self._kept = np.concatenate([kept.along for kept in kept_rows(self.recordings)])
        self._filters = list(_filters(self.recordings))
        self._measured = self.smoothed(motion.effort)
        ends = np.cumsum([0, *(len(kept.along) for kept in kept_rows(self.recordings))])
        self._swings = Swings(self.asked, self._compared, ends)
        counts = {id(r): 0 for r in self.recordings}
        for kept in kept_rows(self.recordings):
            counts[id(kept.recording)] += len(kept.along)
        self.edges = np.cumsum([0, *counts.values()])
        self.rows = np.ones(int(self.edges[-1]), dtype=bool)

    def beside(self, effect: type[Effect]) -> "InverseProblem":
        """The same trials in the same role, with a further effect that may act."""
        effects, about = [*self.effects, effect], (self.sizes, self.rest_speed, self.logs, self.own)
        return InverseProblem(self.rig, self.body, self.recordings, effects, *about, self._held_out)

    @property
    def table(self) -> Table:
        """The rig's own numbers, then those of the effects, brought to its size."""
        return self._table

    @property
    def block(self) -> int:
        """Samples of the residual in half a second."""
        first = self.recordings[0]
        return max(1, round(BLOCK / (first.period * first.every)))

    @property
    def effort(self) -> Effort:
        """What the rig's effort is called, in SI."""
        return Effort(self.rig.effort.title, self.rig.effort.si)

    def measured(self) -> np.ndarray:
        """The measured effort, (N,)."""
        return self._measured

    def __call__(self, changes: Mapping[str, float]) -> np.ndarray:
        """Model minus measurement, (N,)."""
        return self._residual(self.completed(changes))

    def completed(self, changes: Mapping[str, float]) -> dict[str, float]:
        """The changes, with the own numbers of these logs as they fit best."""
        if not self.own:
            return dict(changes)
        start = {name: float(self._table.values[self._table.position(name)]) for name in self.own}

        def residual(values: Mapping[str, float]) -> np.ndarray:
            return self._residual({**changes, **values})

        return {**changes, **profiled(residual, self.own, start)}

    def added(
        self, effect: type[Effect], changes: Mapping[str, float], without: np.ndarray
    ) -> np.ndarray:
        """What an effect changes of the residual, (N,); `without` is the residual without it."""
        torque = self.asked.added(effect, self._table.vector(changes))
        if torque is None:
            return self(changes) - without
        return self.smoothed(torque)

    def shown(self, torque: np.ndarray, changes: Mapping[str, float]) -> np.ndarray:
        """What a further torque on the axis, (n,), changes of the residual, (N,)."""
        own = self.asked.own(self._table.vector(changes))
        moved = late(-torque / own["scale"], own["delay"], self.asked.motion)
        return self.smoothed(moved)

    def many(self, points: Sequence[Mapping[str, float]]) -> list[np.ndarray]:
        """Residuals at several points."""
        return [self(point) for point in points]

    def foretold(self, changes: Mapping[str, float]) -> np.ndarray:
        """Model minus measurement, (N,), where the effort follows from the motion alone.

        Where no effort makes a torque, it is the largest that the drive gave.
        """
        p = self._table.vector(self.completed(changes))
        most = float(np.max(np.abs(self.asked.motion.effort)))
        effort = np.clip(np.nan_to_num(self.asked.effort(p)), -most, most)
        return self._swings.taken(self.smoothed(effort) - self._measured, p, effort)

    def _residual(self, changes: Mapping[str, float]) -> np.ndarray:
        self.work.add(len(self.asked.motion.q))
        p = self._table.vector(changes)
        effort = self.asked.effort(p, near=True)
        residual = self.smoothed(effort) - self._measured
        return self._swings.taken(residual, p, effort)

    def _compared(self, effort: np.ndarray) -> np.ndarray:
        """Of an effort that was played besides, (n,), what is compared, (N,)."""
        self.work.add(len(effort))
        return self.smoothed(effort)

    def stretches(self) -> list[Stretch]:
        """One stretch for each piece of each trial."""
        turns = self.sizes.axis_unit == "rad"
        return [
            Stretch(
                kept.recording.name,
                "",
                kept.piece.seconds[kept.inside],
                kept.piece.q[kept.inside],
                kept.piece.v[kept.inside],
                kept.piece.effort[kept.inside],
                self.rest_speed,
                "forward",
                "backward",
                angle=None
                if self.rig.position is None
                else kept.piece.q[kept.inside] / self.sizes.angle,
                gear=self.rig.gear if turns else None,  # of a slide nothing turns behind the gear
                turn="motor" if self.rig.gear or turns else "stroke",
                **_commanded(kept),
            )
            for kept in kept_rows(self.recordings)
        ]

    def rotors(self) -> list[list[Rotor]]:
        """None: the orders of a ripple come from the residual's spectrum here (`shapes`)."""
        return []

    @property
    def compared(self) -> np.ndarray:
        """Rows of all pieces in a row that are compared, (N,)."""
        return self._kept

    def later(self, delays: np.ndarray, stride: int) -> tuple[np.ndarray, np.ndarray]:
        """Rows of the residual (n,), and the measured effort after each delay [s] there, (n, K).

        Every `stride`-th row is taken, without those that a delay leaves no partner in their piece;
        delays count to the sample.
        """
        effort = self._smooth(self.asked.motion.effort)
        rows, found, count = [], [], 0
        for kept in kept_rows(self.recordings):
            moves = np.rint(delays / kept.recording.period).astype(int)
            first, last = -min(moves.min(), 0), len(kept.piece.q) - max(moves.max(), 0)
            inside = kept.inside[::stride]
            whole = (inside >= first) & (inside < last)
            rows.append(count + stride * np.flatnonzero(whole))
            found.append(effort[kept.along[::stride][whole][:, None] + moves])
            count += len(kept.inside)
        return np.concatenate(rows), np.concatenate(found)

    def raw(self) -> list[np.ndarray]:
        """The unfiltered effort of each piece."""
        return [p.raw for r in self.recordings for p in r.pieces]

    def spaced(self) -> list[int]:
        """All pieces hold every sample of their clock."""
        return [1 for r in self.recordings for _ in r.pieces]

    def filter(self, values: np.ndarray) -> np.ndarray:
        """The filters that measured effort passes."""
        first = self.recordings[0]
        return first.last(first.smooth(values))

    def filtered(self, effort: np.ndarray) -> np.ndarray:
        """An effort at every sample of every piece, (n,), as the measured one is compared, (N,)."""
        parts, k = [], 0
        for recording in self.recordings:
            for piece in recording.pieces:
                parts.append(recording.smooth(effort[k : k + len(piece.q)]))
                k += len(piece.q)
        return self.smoothed(np.concatenate(parts))

    def smoothed(self, values: np.ndarray) -> np.ndarray:
        """A signal at every sample of every piece, (n,), filtered as efforts are, (N,)."""
        return self._thin(self._smooth(values))

    def thinned(self, values: np.ndarray) -> np.ndarray:
        """Of values at every sample of every piece, (n,), those that are compared, (N,)."""
        return self._thin(values)

    def signals(self) -> dict[str, np.ndarray]:
        """Position, speed, acceleration, time and angle of the motor along the residual, (N,)."""
        motion = self.asked.motion
        found = {"position": motion.q, "speed": motion.v, "acceleration": motion.a}
        found |= {"time": motion.seconds, "angle": motion.q / self.sizes.angle}
        return {name: values[self._kept] for name, values in found.items()}

    def compared_motion(self) -> np.ndarray:
        """Position, speed and acceleration, filtered as the effort is compared, (N, 3)."""
        motion = self.asked.motion
        return np.column_stack([self.smoothed(x) for x in (motion.q, motion.v, motion.a)])

    def read(self, changes: Mapping[str, float]) -> dict[str, np.ndarray]:
        """What kernels read at every sample of every piece, (n,), the measured effort among it."""
        asked, vector = self.asked, self.table.vector(self.completed(changes))
        motion = asked.seen(vector)
        signals = asked.signals(motion, asked.load(motion, vector), vector)
        made = asked.made(vector, motion, signals)
        return {**signals, "motor.current": made, "motor.command": made}

    def passing(self, changes: Mapping[str, float]) -> float:
        """Share of the measured effort that its pipes pass on, RMS: what a dead band swallows of an
        effort explains nothing of the motion."""
        vector, signals = self.table.vector(self.completed(changes)), self.read(changes)
        return self.asked.pipes_about(vector, self.asked.seen(vector), signals).passing

    def passed(self, effect: type[Effect], changes: Mapping[str, float]) -> np.ndarray:
        """What a pipe makes of 1 at every sample of every piece, (n,), at the measured effort."""
        vector, signals = self.table.vector(self.completed(changes)), self.read(changes)
        motion = self.asked.seen(vector)
        return self.asked.run(effect, vector, motion, signals, np.ones_like(motion.q))

    def _smooth(self, values: np.ndarray) -> np.ndarray:
        out = np.empty_like(values)
        for rows, last in self._filters:
            out[rows] = last(values[rows])
        return out

    def _thin(self, values: np.ndarray) -> np.ndarray:
        return values[self._kept]


def _filters(recordings: Sequence[Recording]) -> Iterator[tuple[slice, Filter]]:
    """The rows of each piece among those of all, and its last filter."""
    k = 0
    for recording in recordings:
        for piece in recording.pieces:
            yield slice(k, k + len(piece.q)), recording.last_of(piece)
            k += len(piece.q)


def _commanded(kept: Kept) -> dict[str, np.ndarray]:
    """The lag behind the command and the command's rate, where a command was recorded."""
    reference = kept.piece.reference
    if reference is None:
        return {}
    rate = np.gradient(reference, kept.piece.seconds)
    return {
        "lag": (reference - kept.piece.q)[kept.inside],
        "command_rate": rate[kept.inside],
    }
