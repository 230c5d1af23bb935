"""The effort that a measured motion asks for, unfiltered: the equations of the inverse model.

    scale·P(e) = J·a + b·v + k·q + body(q, v, a) - Σ τ_effects(q, v, ...)
    e_model    = S(e)

P are the pipes between the effort and the axis (torque constant, efficiency, dead band), S those
between the effort and its reading (offset, gain, lag).  The first line is solved for e, so that the
model knows nothing of the effort that it is compared with.  The kernels are those of the library,
run over the measured signals.
"""

from collections.abc import Callable, Mapping, Sequence
from threading import Lock

import numpy as np

from spirob.effects import Effect
from spirob.machine.filtering import rates
from spirob.machine.kernel_loop import loop_of
from spirob.machine.motion import Motion
from spirob.machine.rig import NUMBERS
from spirob.machine.scaling import Sizes
from spirob.parameter import Table

PASSES = 12  # of the solution for the effort before the drive's pipes
SHRINKS = 0.5  # what is missed after a pass, over before: above, the step is too short
READ = ("sensing.current", "sensing.report")  # pipes from effort to reading, in their order
BEFORE = ("command.current", "motor.drive_torque")  # pipes from effort to torque, in their order
ADDED = ("motor.torque", "tendon.force", "body.hinge_torque")
CYCLE = 1e-3  # s, of the bus for which effects on its frames are written
REACH = 4  # samples to either side that a second derivative looks at
KEPT = 1e8  # bytes of effects' torques along all trials
SOLVED = 1e-12  # of the largest effort
Run = Callable[..., None]


class AskedEffort:
    """The equations over one motion.

    stiffness   of the driven joint [N·m/rad], which effects at a hinge read
    rest_speed  below which the axis counts as standing
    """

    def __init__(
        self,
        motion: Motion,
        effects: Sequence[type[Effect]],
        table: Table,
        sizes: Sizes,
        rest_speed: float,
        stiffness: float,
    ):
        self.motion, self.effects, self.table, self.sizes = motion, list(effects), table, sizes
        self.rest_speed, self._stiffness = rest_speed, stiffness
        self._runs: dict[str, Run] = {e.name(): loop_of(e) for e in effects}
        self._known: dict[tuple[object, ...], np.ndarray] = {}
        self._lock = Lock()
        self._fixed = self._moving(motion)

    def effort(self, p: np.ndarray) -> np.ndarray:
        """The effort at every sample of every piece, (n,), for a vector of the table."""
        motion = self.seen(p)
        own = self._own(p)
        tip = self.tip_mass(p)
        load = self._load(p, motion, tip)
        needed = load + own["viscous"] * motion.v
        signals = self.signals(motion, load)
        for port in ADDED:
            for effect in self.present(port, p):
                needed = needed - self._torque(effect, p, motion, signals, tip)
        effort = self.solved(needed / own["scale"], p, motion, signals)
        for effect in (e for port in READ for e in self.present(port, p)):
            effort = self.run(effect, p, motion, signals | {"motor.current": effort}, effort)
        for effect in self.present("sensing.frame", p):
            # the motion in the frame is late: compare with the command of that time
            aged = self.in_cycles(effect, p, motion)
            effort = effort + motion.effort - aged
        return late(effort, float(own["delay"]), motion)

    def added(self, effect: type[Effect], p: np.ndarray) -> np.ndarray | None:
        """What an effect adds to the effort, (n,), whatever else acts.

        None where that depends on what else acts: for all but torques, and where a pipe or an error
        of the motion is between them and the effort.
        """
        between = (*BEFORE, "winch.efficiency", *READ, "sensing.displacement")
        if effect.port not in ADDED or any(self.present(port, p) for port in between):
            return None
        own, tip = self._own(p), self.tip_mass(p)
        signals = self.signals(self.motion, self._load(p, self.motion, tip))
        torque = self._torque(effect, p, self.motion, signals, tip)
        return late(-torque / own["scale"], float(own["delay"]), self.motion)

    def _own(self, p: np.ndarray) -> dict[str, float]:
        return {name: p[self.table.position(f"rig.{name}")] for name in NUMBERS}

    def _load(self, p: np.ndarray, motion: Motion, tip: float) -> np.ndarray:
        """What a rigid axis without friction asks for, (n,)."""
        own = self._own(p)
        load = own["inertia"] * motion.a + own["stiffness"] * motion.q + motion.body["load"]
        return load + tip / self.sizes.mass * motion.body["payload"] if tip else load

    def tip_mass(self, p: np.ndarray) -> float:
        """What the body carries at its tip [kg]."""
        return float(sum(e.kernel(**self.values(e, p)) for e in self._at("body.tip_mass")))

    def present(self, port: str, p: np.ndarray) -> list[type[Effect]]:
        """The effects at a port that are not neutral."""
        neutral = self.table.values
        found = []
        for effect in self._at(port):
            cells = [self.table.position(f"{effect.name()}.{f}") for f in effect.neutral]
            if any(p[k] != neutral[k] for k in cells):
                found.append(effect)
        return found

    def values(self, effect: type[Effect], p: np.ndarray) -> dict[str, float]:
        """An effect's numbers, by field, in a vector of the table."""
        name = effect.name()
        return {f: float(p[self.table.position(f"{name}.{f}")]) for f in effect.parameters()}

    def signals(self, motion: Motion, load: np.ndarray) -> dict[str, np.ndarray]:
        """What kernels may read, each (n,)."""
        fixed = self._fixed if motion is self.motion else self._moving(motion)
        return {**fixed, "motor.load_torque": load}

    def _moving(self, motion: Motion) -> dict[str, np.ndarray]:
        """Of these, what follows from the motion alone."""
        n = len(motion.q)
        return {
            "time": motion.seconds,
            "motor.rest_speed": np.full(n, self.rest_speed),
            "motor.speed": motion.v,
            "motor.angle": motion.q / self.sizes.angle,
            "hinge.angle": motion.q,
            "hinge.speed": motion.v,
            "hinge.stiffness": np.full(n, self._stiffness),
            "hinge.weight_x": motion.body["along"],
            "hinge.weight_y": motion.body["across"],
        }

    def solved(
        self, wanted: np.ndarray, p: np.ndarray, motion: Motion, signals: Mapping[str, np.ndarray]
    ) -> np.ndarray:
        """e with P(e) = wanted, by secants from e = wanted.

        Where an effort changes nothing, in a dead band, the steps grow until it does; a secant over
        its edge is of no use there.
        """
        pipes = [e for port in BEFORE for e in self.present(port, p)]
        shares = self.present("winch.efficiency", p)
        effort = wanted
        if not pipes and not shares:
            return effort
        close = SOLVED * np.max(np.abs(wanted))
        step, missed = np.ones_like(effort), np.full_like(effort, np.inf)
        moved, edges = np.zeros_like(effort), np.zeros(len(effort), bool)
        for _ in range(PASSES):
            seen = {**signals, "motor.current": effort, "motor.command": effort}
            passed = effort
            for effect in pipes:
                passed = self.run(effect, p, motion, seen, passed)
            share = np.ones_like(effort)
            for effect in shares:
                share = self.run(effect, p, motion, seen, share)
            miss = wanted - share * passed
            if np.max(np.abs(miss)) <= close:
                break
            flat = (np.sign(miss) == np.sign(missed)) & (np.abs(miss) > SHRINKS * np.abs(missed))
            edges |= flat
            smooth = np.where(edges, 1.0, _secant(moved, missed - miss))
            step = np.where(flat, 2.0 * step, smooth)
            moved, missed = step * miss, miss
            effort = effort + moved
        return effort

    def run(
        self,
        effect: type[Effect],
        p: np.ndarray,
        motion: Motion,
        signals: Mapping[str, np.ndarray],
        upstream: np.ndarray | None,
    ) -> np.ndarray:
        """An effect's kernel at every sample, (n,)."""
        reads = np.array([signals[name] for name in effect.reads.values()])
        n = len(motion.q)
        out = np.empty(n)
        values = np.array(list(self.values(effect, p).values()))
        above = np.zeros(n) if upstream is None else np.ascontiguousarray(upstream)
        self._runs[effect.name()](
            out, motion.starts, motion.steps, above, reads.reshape(len(effect.reads), n), values
        )
        return out

    def in_cycles(self, effect: type[Effect], p: np.ndarray, motion: Motion) -> np.ndarray:
        """The measured effort through a kernel that remembers some cycles of a bus, (n,).

        A log may be faster than any bus: its samples are then dealt out to as many rows, each at
        the pace of a cycle.
        """
        stride = max(1, round(CYCLE / float(np.min(motion.steps))))
        pieces = zip(motion.starts[:-1], motion.starts[1:], strict=True)
        rows = [np.arange(a + k, b, stride) for a, b in pieces for k in range(stride)]
        order = np.concatenate(rows)
        starts = np.cumsum([0, *(len(row) for row in rows)])
        steps = np.repeat(stride * motion.steps, stride)
        values = np.array(list(self.values(effect, p).values()))
        dealt, out = np.empty(len(order)), np.empty(len(order))
        reads = np.empty((0, len(order)))
        self._runs[effect.name()](dealt, starts, steps, motion.effort[order], reads, values)
        out[order] = dealt
        return out

    def _torque(
        self,
        effect: type[Effect],
        p: np.ndarray,
        motion: Motion,
        signals: Mapping[str, np.ndarray],
        tip: float,
    ) -> np.ndarray:
        """An effect's torque; kept, because a derivative moves one number and leaves the others."""
        if motion is not self.motion:
            return self.run(effect, p, motion, signals, None)
        key: tuple[object, ...] = (effect.name(), *self.values(effect, p).values())
        if "motor.load_torque" in effect.reads.values():
            own = (p[self.table.position(f"rig.{n}")] for n in ("inertia", "stiffness"))
            key = (*key, *own, tip)
        with self._lock:
            torque = self._known.pop(key, None)
        if torque is None:
            torque = self.run(effect, p, motion, signals, None)
        with self._lock:
            while len(self._known) * torque.nbytes > KEPT:
                self._known.pop(next(iter(self._known)))  # the one that was asked for longest ago
            self._known[key] = torque
        return torque

    def seen(self, p: np.ndarray) -> Motion:
        """The motion with errors of its sensor taken out."""
        wrong = self.present("sensing.displacement", p)
        if not wrong:
            return self.motion
        signals = self.signals(self.motion, np.zeros_like(self.motion.q))
        error = np.zeros_like(self.motion.q)
        for effect in wrong:
            error += self.run(effect, p, self.motion, signals, self.motion.q) - self.motion.q
        return self.motion.without(error)

    def _at(self, port: str) -> list[type[Effect]]:
        return [e for e in self.effects if e.port == port]


def _secant(moved: np.ndarray, gained: np.ndarray) -> np.ndarray:
    """Step for each unit that is missed, from the last move and its gain; 1 where far from it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        steps = moved / gained
    return np.where((steps > SHRINKS) & (steps < 1.0 / SHRINKS), steps, 1.0)


def late(effort: np.ndarray, delay: float, motion: Motion) -> np.ndarray:
    """e(t - δ): whole samples by moving rows, the rest, half a sample at most, to second order."""
    if delay == 0.0:
        return effort
    out = np.empty_like(effort)
    for k, step in enumerate(motion.steps):
        whole = round(delay / step)
        rest = delay - whole * step
        own = effort[motion.starts[k] : motion.starts[k + 1]]
        moved = _moved(own, rest, step)
        at = np.clip(np.arange(len(own)) - whole, 0, len(own) - 1) if whole else slice(None)
        out[motion.starts[k] : motion.starts[k + 1]] = moved[at]
    return out


def _moved(values: np.ndarray, by: float, period: float) -> np.ndarray:
    """Values (n,) as they were `by` seconds earlier, to second order.

    Away from the ends, where derivatives are one-sided, this is one filter of a few taps.
    """

    def exact(v: np.ndarray) -> np.ndarray:
        first, second = rates(v, period)
        return v - by * first + 0.5 * by**2 * second

    if len(values) <= 6 * REACH:
        return exact(values)
    impulse = exact(np.eye(1, 4 * REACH + 1, 2 * REACH)[0])
    out = np.convolve(values, impulse[REACH : 3 * REACH + 1], "same")
    out[:REACH] = exact(values[: 3 * REACH])[:REACH]
    out[-REACH:] = exact(values[-3 * REACH :])[-REACH:]
    return out
