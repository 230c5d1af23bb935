"""A plain rig and its logs, ready to be searched: what is used of them, and which laws may act."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from spirob.diagnosis.criteria import Criteria
from spirob.diagnosis.search import Search
from spirob.effects import Effect, all_effects
from spirob.errors import ConfigError
from spirob.identify.identifiability import TENTH, Identifiability, probe
from spirob.identify.problem import effort_rms
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.body import RigidBody
from spirob.machine.inverse.numbers import log_numbers, with_payload
from spirob.machine.inverse.problem import InverseProblem, Work
from spirob.machine.inverse.scaling import Sizes, parameters, sizes_of
from spirob.machine.laws import LEVER, SPRING, for_axis, shares_inertia
from spirob.machine.loading import chosen, files
from spirob.machine.recordings.recording import Recording
from spirob.machine.recordings.rests import without_rests
from spirob.machine.recordings.selection import in_stretches, split
from spirob.machine.search.delays import is_told, partnered, strange
from spirob.machine.search.models import Models

DRIVE = {  # port -> what it is, for rigs whose effort a sensor takes behind the motor
    "motor.drive_torque": "the motor's torque per ampere",
    "winch.efficiency": "the gear's efficiency",
    "sensing.current": "the drive's current sensor",
    "sensing.report": "the drive's report of its current",
}
ALWAYS = {"motor.torque", "tendon.force", "sensing.displacement"}
PLACED = {"motor.angle", "winch.displacement", "hinge.angle"}
SIGNALS = {
    "time",
    "motor.rest_speed",
    "motor.current",
    "motor.speed",
    "motor.angle",
    "motor.load_torque",
    "motor.inertia_torque",
    "winch.displacement",
}
HINGE = {
    "hinge.angle",
    "hinge.speed",
    "hinge.stiffness",
    "hinge.weight_x",
    "hinge.weight_y",
}


@dataclass(frozen=True)
class Ready:
    """A rig and its logs, ready to be searched.

    given     the description, before anything that the logs tell was added to `rig`
    held      effects that the model holds;  own  their laws here;  possible  laws that may act
    excluded  name -> why the others may not;  without  names of effects that are no candidates
    said      what was repaired or left out
    untold    nothing is told of the delay between effort and motion
    progress  is told each step
    work      of all searches
    """

    given: RigFile
    rig: RigFile
    body: RigidBody | None
    train: list[Recording]
    test: list[Recording]
    held: Sequence[type[Effect]]
    own: list[type[Effect]]
    possible: list[type[Effect]]
    excluded: dict[str, str]
    sizes: Sizes
    rest_speed: float
    said: list[str]
    untold: bool
    without: Collection[str] = ()
    settings: Criteria = field(default_factory=Criteria)
    progress: Callable[[str], None] = lambda text: None
    work: Work = field(default_factory=Work)

    def at_load(self) -> "Ready":
        """The same logs, read as those of a sensor at the load."""
        assert self.rig.position is not None
        told = self.told(position=self.rig.position.model_copy(update={"side": "load"}))
        own, possible, excluded = library(
            told.rig, told.body, told.train, told.held, told.sizes, told.without
        )
        return replace(told, own=own, possible=possible, excluded=excluded)

    def with_logs(self, train: list[Recording], test: list[Recording]) -> "Ready":
        """The same machine by these logs, whose motion may be of another size."""
        sizes, rest = sizes_of(self.rig, self.body, train)
        sized = replace(self, train=train, test=test, sizes=sizes, rest_speed=rest)
        own, possible, excluded = library(
            self.rig, self.body, train, self.held, sizes, self.without
        )
        return replace(sized, own=own, possible=possible, excluded=excluded)

    def told(self, **changes: Any) -> "Ready":
        """The same with more told of the rig."""
        return replace(self, rig=self.rig.model_copy(update=changes))


def ready_of(
    rig: RigFile,
    folder: Path,
    train: list[Recording],
    test: list[Recording],
    held: Sequence[type[Effect]] | None = None,
    without: Collection[str] = (),
) -> Ready:
    """Logs that are read already, brought to where a search can begin.

    held  the effects that the model holds, where they are found already
    Raises ConfigError where nothing can be fitted, or an effect of the description cannot act.
    """
    if not train:
        raise ConfigError("a diagnosis needs at least one training log")
    held = chosen(files(rig.effects, folder)) if held is None else held
    repairs = [text for r in [*train, *test] for text in r.said]
    body = None if isinstance(rig.body, str) else RigidBody(rig.body, folder, rig.angular)
    sizes, rest = sizes_of(rig, body, train)
    logs, lost = moving(rig, [*train, *test], rest)
    train, test, said = split(logs[: len(train)], logs[len(train) :])
    (train, many), (test, more) = in_stretches(train), in_stretches(test)
    repairs += [*said, *many, *more, *strange(rig, train), *lost]
    own, possible, excluded = library(rig, body, train, held, sizes, without)
    laws = held, own, possible, excluded
    return Ready(
        rig, rig, body, train, test, *laws, sizes, rest, repairs, not is_told(rig), without
    )


def moving(
    rig: RigFile, logs: list[Recording], rest_speed: float
) -> tuple[list[Recording], list[str]]:
    """The logs without rows at standstill, and what is said of it; all where a rig keeps them.

    What of them is held out is to be a part of what is compared, and no rest.
    """
    kept = rig.rows.standstill == "keep" or rig.rows.minimum_speed is not None
    return (logs, []) if kept else without_rests(logs, rest_speed)


def library(
    rig: RigFile,
    body: RigidBody | None,
    train: list[Recording],
    held: Sequence[type[Effect]],
    sizes: Sizes,
    without: Collection[str],
) -> tuple[list[type[Effect]], list[type[Effect]], dict[str, str]]:
    """The laws of the effects that the model holds, of those that may act, why others may not."""
    turned = 0.0 if body or not rig.angular or rig.position is None else _stroke(train)
    side = (rig.position and rig.position.side) or "motor"
    shared = body is None and ("inertia" in rig.fit or rig.known.get("inertia", 0.0) > 0.0)
    given = body is not None and "scale" not in rig.fit
    own = for_axis(held, turned, side, shared, given)
    whole = [e for e in all_effects().values() if e.name() not in without]
    library = [*own, *(e for e in for_axis(whole, turned, side, shared, given) if e not in own)]
    has_tip = not isinstance(rig.body, str) and rig.body.tip is not None
    stiffness = body.stiffness if body else 0.0
    possible, excluded = applicable(library, rig, has_tip, stiffness, rig.angular)
    possible, small = with_room(possible, sizes)
    excluded |= small
    if missing := [e.name() for e in own if e not in possible]:
        raise ConfigError(f"effects: {missing[0]} cannot act here: {excluded[missing[0]]}")
    return own, possible, excluded


def search_of(ready: Ready) -> tuple[Search, Identifiability]:
    """The search over a rig's logs, and what they can say about its numbers."""
    rig = with_payload(ready.rig, ready.sizes)
    fit, held = partnered(rig, ready.train), partnered(rig, ready.test)
    logs = log_numbers(rig, [*fit, *held], ready.sizes)
    fitted = logs.fitted([r.log for r in fit])
    alone = [n for n in logs.fitted([r.log for r in held]) if n not in fitted]
    about = (ready.possible, ready.sizes, ready.rest_speed, logs)
    train = InverseProblem(rig, ready.body, fit, *about, work=ready.work)
    heldout = InverseProblem(rig, ready.body, held, *about, alone, held_out=True)
    names = [*(f"rig.{name}" for name in rig.fit), *fitted]
    names += [f"{e.name()}.{f}" for e in ready.own for f in e.fitted()]
    if names in ([], ["rig.delay"]):
        raise ConfigError("fit: name at least one number to fit, such as viscous")
    table = train.table
    # a delay of a sample or two cannot be silent; a zero shows by laws that the search may choose
    asked = [n for n in names if n != "rig.delay" and not n.startswith("zero.")]
    gate = probe(train, asked, {n: table.about[n].nominal for n in asked})
    shapes = {f"{e.name()}.{f}" for e in ready.own for f in e.fitted() if f not in e.neutral}
    # a shape may say nothing until its amplitude is another
    if lost := [name for name in gate.silent if name not in shapes]:
        raise ConfigError(_unseen(lost, gate, train))
    absent = [e for e in ready.possible if e not in ready.own]
    models = Models(train, heldout, names, ready.settings.floor)
    return Search(models, absent, ready.settings, ready.progress), gate


def _unseen(names: Sequence[str], gate: Identifiability, train: InverseProblem) -> str:
    """That the effort shows nothing of these numbers, with what each makes of it."""
    about, size = train.table.about, effort_rms(train)
    unit = train.rig.effort.si
    made = [
        f"{n.removeprefix('rig.')} of {about[n].nominal:g} {about[n].unit} makes "
        f"{gate.moves[n] / TENTH:.2g} {unit}"
        for n in names
    ]
    return (
        f"fit: {', '.join(made)} of an effort of {size:.2g} {unit}, which cannot be seen: a unit, "
        "a factor, a nominal value or the values of some rows are many times off, or the motion "
        "asks for none of it, as a constant speed does of an inertia."
    )


def _stroke(recordings: list[Recording]) -> float:
    return float(np.ptp(np.concatenate([p.q[p.use] for r in recordings for p in r.pieces])))


def applicable(
    effects: Sequence[type[Effect]], rig: RigFile, has_tip: bool, stiffness: float, angular: bool
) -> tuple[list[type[Effect]], dict[str, str]]:
    """The effects that this rig can show, and name -> reason for those that it cannot."""
    possible, excluded = [], {}
    for effect in effects:
        reason = _reason(effect, rig, has_tip, stiffness, angular)
        if reason:
            excluded[effect.name()] = reason
        else:
            possible.append(effect)
    return possible, excluded


def with_room(
    effects: Sequence[type[Effect]], sizes: Sizes
) -> tuple[list[type[Effect]], dict[str, str]]:
    """The effects that a motion of this size can show, and name -> reason for the others."""
    possible, excluded = [], {}
    for effect in effects:
        closed = [n for n, about in parameters(effect, sizes).items() if not about.low < about.high]
        if closed:
            excluded[effect.name()] = (
                f"the motion is too small to show it: nothing is left between the bounds of its "
                f"number '{closed[0]}'"
            )
        else:
            possible.append(effect)
    return possible, excluded


def _reason(
    effect: type[Effect], rig: RigFile, has_tip: bool, stiffness: float, angular: bool
) -> str:
    port, reads = effect.port, set(effect.reads.values())
    hinged = not isinstance(rig.body, str)
    if rig.position is None and (reads & PLACED or port == "sensing.displacement"):
        return "the log has no position"
    if effect.name() == SPRING and "stiffness" in {*rig.fit, *rig.known}:
        return "the description has a spring"
    if shares_inertia(effect) and not (hinged or "inertia" in rig.fit or rig.known.get("inertia")):
        return "the rig moves no inertia that could stay behind"
    if port == "command.current" and rig.effort.origin != "command":
        return "the log holds no commanded effort to compare with"
    if port == "sensing.report" and rig.effort.origin == "command":
        return "a logged command is no report of a current"
    if port == "sensing.current" and rig.effort.kind in ("voltage", "duty"):
        return f"a {rig.effort.kind} is regulated by no sensor of a current"
    if port == "motor.drive_torque" and "motor.current" in reads and not _tells_current(rig):
        return f"a {rig.effort.kind} tells no current where no `back_emf` is fitted or known"
    if port == "sensing.frame" and reads:
        return "the frame of a bus is not in the log"
    if port in DRIVE and rig.effort.origin == "sensor":
        return f"{DRIVE[port]} lies before the sensor that measures this effort"
    if port == "body.tip_mass":
        return "" if has_tip else "the rig's body has no tip that carries anything"
    if effect in LEVER.values():
        return ""
    if port == "body.hinge_torque":
        if not hinged or not angular:
            return "the rig has no hinged body"
        if "hinge.stiffness" in reads and stiffness <= 0.0:
            return "the driven joint has no spring"
        return _unread(reads - SIGNALS - HINGE)
    if port not in ALWAYS | set(DRIVE) | {"command.current", "sensing.frame"}:
        return f"the rig has no {port.replace('.', ' ')}"
    missing = reads - SIGNALS - ({"motor.command"} if rig.effort.origin == "command" else set())
    return _unread(missing)


def _tells_current(rig: RigFile) -> bool:
    """Whether the effort, less a back-EMF, is in proportion to the motor's current."""
    return rig.effort.kind not in ("voltage", "duty") or "back_emf" in {*rig.fit, *rig.known}


def _unread(missing: set[str]) -> str:
    return f"the log has no {', '.join(sorted(missing))}" if missing else ""
