"""The inverse model of a rig: the effort that its measured motion asks for.

    scale·P(e) = J·a + b·v + k·q + body(q, v, a) - Σ τ_effects(q, v, ...)
    e_model    = S(e)

P are the pipes between the effort and the axis (torque constant, efficiency, dead band), S those
between the effort and its reading (offset, gain, lag).  The first line is solved for e, so that the
model knows nothing of the effort that it is compared with.  Measured and modelled effort pass the
same filters.  The kernels are those of the library, run over the measured signals.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from spirob.effects import Effect
from spirob.identify.problem import Effort, Stretch
from spirob.machine.body import RigidBody
from spirob.machine.kernel_loop import loop_of
from spirob.machine.recording import Recording, rates
from spirob.machine.rig import NUMBERS, SI, RigFile
from spirob.machine.scaling import Sizes, parameters
from spirob.parameter import Parameter, Table

SYMBOLS = {"inertia": "J", "viscous": "b", "stiffness": "k", "scale": "k_e"}
PASSES = 8  # of the solution for the effort before the drive's pipes
BEFORE = ("command.current", "motor.drive_torque")  # pipes from effort to torque, in their order
KEPT = 24  # torques of effects, as arrays along all trials
BLOCK = 0.5  # s, over which a residual is correlated at most
Run = Callable[..., None]


@dataclass
class Motion:
    """The signals of all pieces in a row, each (n,), and what the body asks for along them."""

    starts: np.ndarray
    steps: np.ndarray
    seconds: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    effort: np.ndarray
    body: dict[str, np.ndarray]


class InverseProblem:
    """Effort asked for minus effort measured, on the trials of one role; see `identify.problem`.

    sizes  of the rig, which set the effects' nominal numbers; shared by all roles
    """

    def __init__(
        self,
        rig: RigFile,
        body: RigidBody | None,
        recordings: Sequence[Recording],
        effects: Sequence[type[Effect]],
        sizes: Sizes,
        rest_speed: float,
    ):
        self.rig, self.recordings, self.sizes = rig, list(recordings), sizes
        self.effects, self.rest_speed = list(effects), rest_speed
        self._runs: dict[str, Run] = {e.name(): loop_of(e) for e in effects}
        self._motion = _collect(self.recordings, body, sizes.mass)
        self._tip_mass, self._stiffness = sizes.mass, body.stiffness if body else 0.0
        self._kept = self._kept_rows()
        self._known: dict[tuple[object, ...], np.ndarray] = {}
        self._measured = self._thin(self._smooth(self._motion.effort))
        self.edges = np.cumsum([0, *(len(rows) for rows in self._by_recording())])
        self.rows = np.ones(int(self.edges[-1]), dtype=bool)

    @cached_property
    def table(self) -> Table:
        """The rig's own numbers, then those of the effects, brought to its size."""
        about = {f"rig.{name}": self._own(name) for name in NUMBERS}
        values = {f"rig.{name}": value for name, value in self.rig.known.items()}
        for effect in self.effects:
            for field, number in parameters(effect, self.sizes).items():
                full = f"{effect.name()}.{field}"
                about[full] = number
                declared = effect.parameters()[field]
                if field in effect.neutral:
                    values[full] = effect.neutral[field] * self.sizes.ratio(declared.unit)
        return Table.of(about, values)

    @property
    def block(self) -> int:
        """Samples of the residual in half a second."""
        first = self.recordings[0]
        return max(1, round(BLOCK / (first.period * first.every)))

    @property
    def effort(self) -> Effort:
        """What the rig's effort is called, in SI."""
        kind = self.rig.effort.kind
        return Effort(self.rig.effort.name or f"motor {kind}", SI[kind])

    def measured(self) -> np.ndarray:
        """The measured effort, (N,)."""
        return self._measured

    def __call__(self, changes: Mapping[str, float]) -> np.ndarray:
        """Model minus measurement, (N,)."""
        return self._thin(self.model(changes)) - self._measured

    def many(self, points: Sequence[Mapping[str, float]]) -> list[np.ndarray]:
        """Residuals at several points."""
        return [self(point) for point in points]

    def stretches(self) -> list[Stretch]:
        """One stretch for each piece of each trial."""
        found = []
        for recording, piece, rows in self._pieces():
            inside = rows - rows_start(rows, self._motion.starts)
            found.append(
                Stretch(
                    recording.name,
                    "",
                    piece.seconds[inside],
                    piece.q[inside],
                    piece.v[inside],
                    piece.effort[inside],
                    self.rest_speed,
                    "forward",
                    "backward",
                )
            )
        return found

    def raw(self) -> list[np.ndarray]:
        """The unfiltered effort of each piece."""
        return [p.raw for r in self.recordings for p in r.pieces]

    def filter(self, values: np.ndarray) -> np.ndarray:
        """The filters that measured effort passes."""
        first = self.recordings[0]
        return first.last(first.smooth(values))

    def signals(self) -> dict[str, np.ndarray]:
        """Position, speed, acceleration, time and angle of the motor along the residual, (N,)."""
        motion = self._motion
        found = {"position": motion.q, "speed": motion.v, "acceleration": motion.a}
        found |= {"time": motion.seconds, "angle": motion.q / self.sizes.angle}
        return {name: values[self._kept] for name, values in found.items()}

    def model(self, changes: Mapping[str, float]) -> np.ndarray:
        """The modelled effort at every sample of every piece, filtered, (n,)."""
        p = self.table.vector(changes)
        get = self.table.position
        motion = self._seen(p)
        own = {name: p[get(f"rig.{name}")] for name in NUMBERS}
        load = own["inertia"] * motion.a + own["stiffness"] * motion.q + motion.body["load"]
        tip = sum(e.kernel(**self.values(e, p)) for e in self._at("body.tip_mass"))
        if tip:
            load = load + tip / self._tip_mass * motion.body["payload"]
        needed = load + own["viscous"] * motion.v
        signals = self._signals(motion, load)
        for port in ("motor.torque", "tendon.force", "body.hinge_torque"):
            for effect in self.present(port, p):
                needed = needed - self._sum(effect, p, motion, signals, tip)
        effort = self._solved(needed / own["scale"], p, motion, signals)
        for effect in self.present("sensing.current", p):
            effort = self._run(effect, p, motion, signals | {"motor.current": effort}, effort)
        for effect in self.present("sensing.frame", p):
            # the motion in the frame is late: compare with the command of that time
            late = self._run(effect, p, motion, signals, motion.effort)
            effort = effort + motion.effort - late
        return self._smooth(effort)

    def _sum(
        self,
        effect: type[Effect],
        p: np.ndarray,
        motion: Motion,
        signals: Mapping[str, np.ndarray],
        tip: float,
    ) -> np.ndarray:
        """An effect's torque; kept, because a derivative moves one number and leaves the others."""
        if motion is not self._motion:
            return self._run(effect, p, motion, signals, None)
        key: tuple[object, ...] = (effect.name(), *self.values(effect, p).values())
        if "motor.load_torque" in effect.reads.values():
            own = (p[self.table.position(f"rig.{n}")] for n in ("inertia", "stiffness"))
            key = (*key, *own, tip)
        if key not in self._known:
            if len(self._known) >= KEPT:
                self._known.pop(next(iter(self._known)))
            self._known[key] = self._run(effect, p, motion, signals, None)
        return self._known[key]

    def _solved(
        self, wanted: np.ndarray, p: np.ndarray, motion: Motion, signals: Mapping[str, np.ndarray]
    ) -> np.ndarray:
        """e with P(e) = wanted, by fixed-point iteration from e = wanted."""
        pipes = [e for port in BEFORE for e in self.present(port, p)]
        shares = self.present("winch.efficiency", p)
        effort = wanted
        if not pipes and not shares:
            return effort
        for _ in range(PASSES):
            seen = {**signals, "motor.current": effort, "motor.command": effort}
            passed = effort
            for effect in pipes:
                passed = self._run(effect, p, motion, seen, passed)
            share = np.ones_like(effort)
            for effect in shares:
                share = self._run(effect, p, motion, seen, share)
            effort = effort + (wanted - share * passed)
        return effort

    def _seen(self, p: np.ndarray) -> Motion:
        """The motion with errors of its sensor taken out."""
        motion = self._motion
        wrong = self.present("sensing.displacement", p)
        if not wrong:
            return motion
        signals = self._signals(motion, np.zeros_like(motion.q))
        error = np.zeros_like(motion.q)
        for effect in wrong:
            error += self._run(effect, p, motion, signals, motion.q) - motion.q
        v, a = motion.v.copy(), motion.a.copy()
        for k, step in enumerate(motion.steps):
            rows = slice(motion.starts[k], motion.starts[k + 1])
            fast, faster = rates(error[rows], step)
            v[rows] -= fast
            a[rows] -= faster
        return Motion(
            motion.starts,
            motion.steps,
            motion.seconds,
            motion.q - error,
            v,
            a,
            motion.effort,
            motion.body,
        )

    def _signals(self, motion: Motion, load: np.ndarray) -> dict[str, np.ndarray]:
        n = len(motion.q)
        found = {
            "time": motion.seconds,
            "motor.rest_speed": np.full(n, self.rest_speed),
            "motor.speed": motion.v,
            "motor.angle": motion.q / self.sizes.angle,
            "motor.load_torque": load,
            "hinge.angle": motion.q,
            "hinge.speed": motion.v,
            "hinge.stiffness": np.full(n, self._stiffness),
            "hinge.weight_x": motion.body["along"],
            "hinge.weight_y": motion.body["across"],
        }
        return found

    def _run(
        self,
        effect: type[Effect],
        p: np.ndarray,
        motion: Motion,
        signals: Mapping[str, np.ndarray],
        upstream: np.ndarray | None,
    ) -> np.ndarray:
        reads = np.array([signals[name] for name in effect.reads.values()])
        n = len(motion.q)
        out = np.empty(n)
        values = np.array(list(self.values(effect, p).values()))
        above = np.zeros(n) if upstream is None else np.ascontiguousarray(upstream)
        self._runs[effect.name()](
            out, motion.starts, motion.steps, above, reads.reshape(len(effect.reads), n), values
        )
        return out

    def values(self, effect: type[Effect], p: np.ndarray) -> dict[str, float]:
        """An effect's numbers, by field, in a vector of the table."""
        name = effect.name()
        return {f: float(p[self.table.position(f"{name}.{f}")]) for f in effect.parameters()}

    def _at(self, port: str) -> list[type[Effect]]:
        return [e for e in self.effects if e.port == port]

    def present(self, port: str, p: np.ndarray) -> list[type[Effect]]:
        """The effects at a port that are not neutral."""
        neutral = self.table.values
        found = []
        for effect in self._at(port):
            cells = [self.table.position(f"{effect.name()}.{f}") for f in effect.neutral]
            if any(p[k] != neutral[k] for k in cells):
                found.append(effect)
        return found

    def _own(self, name: str) -> Parameter:
        units = {
            "inertia": f"{self.sizes.torque_unit}·s²/{self.sizes.axis_unit}",
            "viscous": f"{self.sizes.torque_unit}·s/{self.sizes.axis_unit}",
            "stiffness": f"{self.sizes.torque_unit}/{self.sizes.axis_unit}",
            "scale": f"{self.sizes.torque_unit}/{self.sizes.effort_unit}",
        }
        if units["inertia"] == "N·s²/m":
            units["inertia"] = "kg"
        if units["inertia"] == "N·m·s²/rad":
            units["inertia"] = "kg·m²"
        chosen = self.rig.fit.get(name)
        value = self.rig.known.get(name, 1.0 if name == "scale" else 0.0)
        low, high, nominal = value, value, value
        if chosen is not None:
            low, high, nominal = chosen.low, chosen.high, chosen.nominal
        return Parameter(nominal, low, high, units[name], SYMBOLS[name], NUMBERS[name])

    def _smooth(self, values: np.ndarray) -> np.ndarray:
        out = np.empty_like(values)
        k = 0
        for recording in self.recordings:
            for piece in recording.pieces:
                rows = slice(k, k + len(piece.q))
                out[rows] = recording.last(values[rows])
                k += len(piece.q)
        return out

    def _thin(self, values: np.ndarray) -> np.ndarray:
        return values[self._kept]

    def _pieces(self):  # type: ignore[no-untyped-def]
        k = 0
        for recording in self.recordings:
            for piece in recording.pieces:
                inside = np.arange(0, len(piece.q), recording.every)
                inside = inside[piece.use[inside]]
                yield recording, piece, k + inside
                k += len(piece.q)

    def _kept_rows(self) -> np.ndarray:
        return np.concatenate([rows for _, _, rows in self._pieces()])

    def _by_recording(self) -> list[np.ndarray]:
        found: dict[int, list[np.ndarray]] = {id(r): [] for r in self.recordings}
        for recording, _, rows in self._pieces():
            found[id(recording)].append(rows)
        return [np.concatenate(parts) for parts in found.values()]


def rows_start(rows: np.ndarray, starts: np.ndarray) -> int:
    """Where the piece begins that holds these rows."""
    return int(starts[np.searchsorted(starts, rows[0], "right") - 1]) if len(rows) else 0


def _collect(recordings: Sequence[Recording], body: RigidBody | None, mass: float) -> Motion:
    pieces = [(r, p) for r in recordings for p in r.pieces]
    names = ("load", "payload", "along", "across")
    needs = []
    for _, piece in pieces:
        nothing = {name: np.zeros(len(piece.q)) for name in names}
        needs.append(body.needs(piece, mass) if body else nothing)
    joined = {name: np.concatenate([n[name] for n in needs]) for name in names}

    def along(field: str) -> np.ndarray:
        return np.concatenate([getattr(p, field) for _, p in pieces])

    return Motion(
        np.cumsum([0, *(len(p.q) for _, p in pieces)]),
        np.array([r.period for r, _ in pieces]),
        along("seconds"),
        along("q"),
        along("v"),
        along("a"),
        along("effort"),
        joined,
    )
