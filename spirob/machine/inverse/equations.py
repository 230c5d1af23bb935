"""The effort that a measured motion asks for, unfiltered: the equations of the inverse model.

    scale·P(e) = J·a + b·v + k·q + body(q, v, a) + m·(J_p·a + P_c·cos q + P_s·sin q) + F
                 - Σ τ_effects(q, v, ...)
    e_model    = S(e + k_b·v)

m and F are the payload and the force of each log (`numbers`), k_b is a voltage's back-EMF.  The
load that friction may feel is what the transmission passes on.  Where a body is described, J is the
motor's own inertia and no part of that; where none is, nothing tells the two apart.
P are the pipes between the effort and the axis (torque constant, efficiency, dead band), S those
between the effort and its reading (offset, gain, lag).  The first line is solved for e, so that the
model knows nothing of a measured effort.  Where it is compared with one, e₀, it is taken about it,

    e = e₀ + (wanted - P(e₀))/P'

since the inverse is no fair judge of P: in a dead band one torque has many efforts, and where iron
is full a torque may have none.  The current that P reads, which fills the iron and heats the
winding, is e₀ and does not move with e: P' is then the torque of an ampere as the motor stood.
That makes errors of full iron smaller than they are, so those of trials held out are by what an
ampere more gives, e₀ being what P remembers, such as heat.  The kernels are those of the library.
"""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from spirob.effects import Effect
from spirob.machine.description.rig import NUMBERS
from spirob.machine.inverse import kernel_loop
from spirob.machine.inverse.kernel_loop import Cache, Kernels, Tangent
from spirob.machine.inverse.motion import Motion, late
from spirob.machine.inverse.numbers import cells_of
from spirob.machine.inverse.scaling import Sizes
from spirob.parameter import Table

Signals = Mapping[str, np.ndarray]  # what kernels may read, (n,) each
READ = ("sensing.current", "sensing.report")  # pipes from effort to reading, in their order
BEFORE = ("command.current", "motor.drive_torque")  # pipes from effort to torque, in their order
LAST = "winch.efficiency"
READINGS = 4  # passes to where a wrong reading was taken; each leaves a small part of the last
HINGE, SENSOR = "body.hinge_torque", "sensing.displacement"
ADDED = ("motor.torque", "tendon.force")
MOVED = {"motor.load_torque", "motor.inertia_torque"}  # what is read of the load
KEPT = 1e8  # bytes of effects' torques along all trials
MOTIONS = 16  # corrected ones that are kept: a set of derivatives moves few numbers of a sensor
TANGENTS = 16  # of the pipes, that are kept


class AskedEffort(Kernels):
    """The equations over one motion.

    stiffness   of the driven joint [N·m/rad], which effects at a hinge read
    rest_speed  below which the axis counts as standing
    described   whether a body is, which carries what is moved beside the motor
    held_out    whether these trials judge a fit: P' is what an ampere more gives
    """

    def __init__(
        self,
        motion: Motion,
        effects: Sequence[type[Effect]],
        table: Table,
        sizes: Sizes,
        rest_speed: float,
        stiffness: float,
        described: bool,
        held_out: bool = False,
    ):
        super().__init__(effects, table)
        self.held_out = held_out
        self.motion, self.sizes = motion, sizes
        self.rest_speed, self._stiffness = rest_speed, stiffness
        self._described, self._carries = described, bool(np.any(motion.body["payload"]))
        self._of_logs = cells_of(table, motion.logs)
        self._carried = self._load_cells()
        self._torques: Cache[np.ndarray] = Cache(int(KEPT / (motion.q.nbytes + 1)))
        self._corrections: Cache[tuple[Motion, dict[str, np.ndarray]]] = Cache(MOTIONS)
        self._tangents: Cache[Tangent] = Cache(TANGENTS)
        self._correcting, self._piping = self._correcting_cells(), self._piping_cells()
        self._fixed = self._moving(motion)
        self._read: tuple[float, np.ndarray] = (0.0, motion.effort)

    def anew(self) -> "AskedEffort":
        """The same where what effects remember begins anew with each piece."""
        motion = replace(self.motion, follows=())
        about = (self.rest_speed, self._stiffness, self._described, self.held_out)
        return AskedEffort(motion, self.effects, self.table, self.sizes, *about)

    def effort(self, p: np.ndarray, near: bool = False) -> np.ndarray:
        """The effort at every sample of every piece, (n,), for a vector of the table.

        near  to first order about the measured effort, which it is compared with
        """
        own = self.own(p)
        behind = self._corrected(p)
        load = self.load(behind, p)
        motion, share = self._ahead(behind, load, p)
        needed = load + own["viscous"] * motion.v + self.of_log("offset", p)
        if self._described:
            needed = needed + own["inertia"] * motion.a
        elif motion is not behind:
            needed = needed + share * own["inertia"] * (motion.a - behind.a)
        signals = self.signals(motion, load, p)
        for port in ADDED:
            for effect in self.present(port, p):
                needed = needed - self.torque(effect, p, motion, signals)
        effort = needed / own["scale"]
        if any(self.present(port, p) for port in (*BEFORE, LAST)):
            passed = self._nearby if near else self.through
            effort = passed(effort, p, motion, signals)
        if own["back_emf"]:
            effort = effort + own["back_emf"] * motion.v
        effort = late(self._shown(effort, p, motion, signals), own["delay"], motion)
        for effect in self.present("sensing.frame", p):
            # the motion in the frame is late: compare with the command of that time
            effort = effort + motion.effort - self.in_cycles(effect, p, motion)
        return effort

    def own(self, p: np.ndarray) -> dict[str, float]:
        """The rig's own numbers, by name."""
        return {name: float(p[self.table.position(f"rig.{name}")]) for name in NUMBERS}

    def of_log(self, kind: str, p: np.ndarray) -> np.ndarray | float:
        """A number that each log has for itself, at every sample (n,); 0 where none has."""
        cells = self._of_logs.get(kind)
        return self.motion.spread(p[cells]) if cells else 0.0

    def load(self, motion: Motion, p: np.ndarray) -> np.ndarray:
        """What the transmission passes on to this motion, (n,); without a body, all of it."""
        own = self.own(p)
        load = own["stiffness"] * motion.q + motion.body["load"]
        if not self._described:
            load = load + own["inertia"] * motion.a
        tip = self.tip_mass(p) + self.of_log("payload", p)
        if np.any(tip):
            load = load + tip * self._payload(motion, own)
        signals = self.signals(motion, load, p)
        for effect in self.present(HINGE, p):
            load = load - self.torque(effect, p, motion, signals)
        return load

    def _payload(self, motion: Motion, own: Mapping[str, float]) -> np.ndarray:
        """What a payload of 1 adds to the load, (n,)."""
        if self._carries:
            return motion.body["payload"] / self.sizes.mass
        cosine, sine = motion.turned if self.sizes.axis_unit == "rad" else (1.0, 0.0)
        weight = own["payload_cosine"] * cosine + own["payload_sine"] * sine
        return own["payload_inertia"] * motion.a + weight

    def added(self, effect: type[Effect], p: np.ndarray) -> np.ndarray | None:
        """What an effect adds to the effort, (n,), whatever else acts.

        None where that depends on what else acts: for all but torques, where a pipe or an error of
        the motion is between them and the effort, and for a load where friction feels it.
        """
        if any(self.present(port, p) for port in (*BEFORE, LAST, *READ, SENSOR)):
            return None
        felt = any(kernel_loop.feels_load(e) for port in ADDED for e in self.present(port, p))
        if effect.port not in ADDED and (effect.port != HINGE or felt):
            return None
        signals = self.signals(self.motion, self.load(self.motion, p), p)
        own = self.own(p)
        torque = self.torque(effect, p, self.motion, signals)
        return late(-torque / own["scale"], own["delay"], self.motion)

    def tip_mass(self, p: np.ndarray) -> float:
        """What the body carries at its tip [kg]."""
        tips = self.present("body.tip_mass", p)
        return float(sum(e.kernel(**self.values(e, p)) for e in tips))

    def signals(self, motion: Motion, load: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """What kernels may read, each (n,)."""
        shared = 0.0 if self._described else float(p[self.table.position("rig.inertia")])
        known = [fixed for _, (kept, fixed) in self._corrections.items() if kept is motion]
        known += [self._fixed] if motion is self.motion else []
        fixed = known[0] if known else self._moving(motion)
        return {**fixed, "motor.load_torque": load, "motor.inertia_torque": shared * motion.a}

    def _moving(self, motion: Motion) -> dict[str, np.ndarray]:
        """Of these, what follows from the motion alone."""
        n = len(motion.q)
        return {
            "time": motion.seconds,
            "motor.rest_speed": np.full(n, self.rest_speed),
            "motor.speed": motion.v,
            "motor.angle": motion.q / self.sizes.angle,
            "winch.displacement": motion.q,
            "hinge.angle": motion.q,
            "hinge.speed": motion.v,
            "hinge.stiffness": np.full(n, self._stiffness),
            "hinge.weight_x": motion.body["along"],
            "hinge.weight_y": motion.body["across"],
        }

    def through(
        self, wanted: np.ndarray, p: np.ndarray, motion: Motion, signals: Signals
    ) -> np.ndarray:
        """e with P(e) = wanted, (n,)."""
        return kernel_loop.solved(lambda e: self._passed(e, p, motion, signals), wanted)

    def _nearby(
        self, wanted: np.ndarray, p: np.ndarray, motion: Motion, signals: Signals
    ) -> np.ndarray:
        """The same to first order about the measured effort, from before its reading.

        Its tangent is kept: a derivative by what is no number of a pipe does not turn it.
        """
        mark = self._mark(motion)
        if mark is None:
            return self.pipes_about(p, motion, signals).reached(wanted)
        key = (mark, p[self._piping].tobytes())
        return self._tangents(key, lambda: self.pipes_about(p, motion, signals)).reached(wanted)

    def pipes_about(self, p: np.ndarray, motion: Motion, signals: Signals) -> Tangent:
        """The pipes about the measured effort, from before its reading."""
        before = self.made(p, motion, signals)
        at = {**signals, "motor.current": before, "motor.command": before}
        return kernel_loop.tangent(lambda e: self._passed(e, p, motion, at), before)

    def made(self, p: np.ndarray, motion: Motion, signals: Signals) -> np.ndarray:
        """The measured effort from before its reading, without back-EMF, when it was made, (n,)."""
        own = self.own(p)
        read = self._in_time(own["delay"], motion) - own["back_emf"] * motion.v
        if not any(self.present(port, p) for port in READ):
            return read
        return kernel_loop.nearby(lambda e: self._shown(e, p, motion, signals), read, read)

    def _in_time(self, delay: float, motion: Motion) -> np.ndarray:
        """The measured effort when it was made, (n,); kept, because it has one delay mostly."""
        known, read = self._read
        if known != delay:
            read = late(motion.effort, -delay, motion)
            self._read = delay, read
        return read

    def _shown(
        self, effort: np.ndarray, p: np.ndarray, motion: Motion, signals: Signals
    ) -> np.ndarray:
        """S(e), what is read of an effort, (n,)."""
        for effect in (e for port in READ for e in self.present(port, p)):
            seen = {**signals, "motor.current": effort}
            effort = self.run(effect, p, motion, seen, effort)
        return effort

    def _passed(
        self, effort: np.ndarray, p: np.ndarray, motion: Motion, signals: Signals
    ) -> np.ndarray:
        """P(e), the torque that an effort makes over what it would make without the pipes, (n,).

        P reads the current of `signals`, if told; held out, only what remembers does.
        """
        own = {"motor.current": effort, "motor.command": effort}
        now, told = {**signals, **own}, {**own, **signals}
        passed, share = effort, np.ones_like(effort)
        for effect in (e for port in (*BEFORE, LAST) for e in self.present(port, p)):
            seen = now if self.held_out and not effect.state else told
            if effect.port == LAST:
                share = self.run(effect, p, motion, seen, share)
            else:
                passed = self.run(effect, p, motion, seen, passed)
        return share * passed

    def torque(
        self, effect: type[Effect], p: np.ndarray, motion: Motion, signals: Signals
    ) -> np.ndarray:
        """An effect's torque; kept, because a derivative moves one number and leaves the others."""
        mark = self._mark(motion)
        if mark is None:
            return self.run(effect, p, motion, signals, None)
        key: tuple[object, ...] = (effect.name(), mark, *self.values(effect, p).values())
        if kernel_loop.feels_load(effect):
            key = (*key, p[self._carried].tobytes())
        return self._torques(key, lambda: self.run(effect, p, motion, signals, None))

    def _mark(self, motion: Motion) -> Hashable:
        """What a motion was corrected by; None of one that is not kept."""
        if motion is self.motion:
            return b""
        return next((m for m, (kept, _) in self._corrections.items() if kept is motion), None)

    def seen(self, p: np.ndarray) -> Motion:
        """The motor's motion: what its sensor tells, without the errors that the model holds."""
        behind = self._corrected(p)
        return self._ahead(behind, self.load(behind, p), p)[0]

    def _corrected(self, p: np.ndarray) -> Motion:
        """The motion with errors of its sensor taken out; kept as effects' torques are."""
        wrong = [e for e in self.present(SENSOR, p) if not kernel_loop.feels_load(e)]
        if not wrong and not np.any(self.of_log("zero", p)):
            return self.motion

        def corrected() -> tuple[Motion, dict[str, np.ndarray]]:
            motion = self._rightly_read(wrong, p)
            return motion, self._moving(motion)

        return self._corrections(p[self._correcting].tobytes(), corrected)[0]

    def _rightly_read(self, wrong: Sequence[type[Effect]], p: np.ndarray) -> Motion:
        """The motion counted from each log's own zero, without these errors of its sensor."""
        zero, found = self.of_log("zero", p), self.motion
        if np.any(zero):
            found = replace(found, q=found.q - zero)
        error = still = np.zeros_like(found.q)
        for _ in range(READINGS if wrong else 0):  # it depends on the place itself, not as read
            error = self._misread(wrong, p, replace(found, q=found.q - error), still)
        return found.without(error) if wrong else found

    def _ahead(self, behind: Motion, load: np.ndarray, p: np.ndarray) -> tuple[Motion, float]:
        """The motor's motion where the sensor sits at the load, and its share of the inertia."""
        twisted = [e for e in self.present(SENSOR, p) if kernel_loop.feels_load(e)]
        if not twisted:
            return behind, 0.0
        share = max(self.values(e, p).get("rotor_share", 0.0) for e in twisted)
        return behind.without(self._misread(twisted, p, behind, load)), share

    def _misread(
        self, wrong: Sequence[type[Effect]], p: np.ndarray, motion: Motion, load: np.ndarray
    ) -> np.ndarray:
        """What the sensor reads beside this motion, (n,)."""
        signals = self.signals(motion, load, p)
        error = np.zeros_like(motion.q)
        for effect in wrong:
            error += self.run(effect, p, motion, signals, motion.q) - motion.q
        return error

    def _correcting_cells(self) -> list[int]:
        """Places in the table of all numbers that the motion is corrected by."""
        owners = {e.name() for e in self.at(SENSOR) if not kernel_loop.feels_load(e)}
        cells = [k for k, n in enumerate(self.table.names) if n.partition(".")[0] in owners]
        return [*cells, *self._of_logs.get("zero", [])]

    def _piping_cells(self) -> list[int]:
        """Places in the table of all numbers that the pipes about the measured effort depend on."""
        inside = [e for port in (*READ, *BEFORE, LAST) for e in self.at(port)]
        owners, names = {e.name() for e in inside}, self.table.names
        cells = [k for k, n in enumerate(names) if n.partition(".")[0] in owners]
        moved = any(MOVED & set(e.reads.values()) for e in inside)
        cells += [self.table.position(f"rig.{name}") for name in ("delay", "back_emf")]
        return cells + (self._carried if moved else [])

    def _load_cells(self) -> list[int]:
        """Places in the table of all numbers that the load depends on."""
        owners = {e.name() for port in (HINGE, "body.tip_mass") for e in self.at(port)}
        rig = ("inertia", "stiffness", "payload_inertia", "payload_cosine", "payload_sine")
        owners |= {"payload", *(f"rig.{name}" for name in rig)}
        names = self.table.names
        return [k for k, n in enumerate(names) if n in owners or n.partition(".")[0] in owners]
