"""All numbers of a rig's inverse model: its own, those of single logs, those of the effects.

A log may have numbers for itself: a force, what the axis carries, where its position begins.  Three
masses on one lever, three pressures in one cylinder, a mount that was moved: the logs share
a machine, and differ in one number each.  `logs` in a description gives it, `per_log` has it
fitted; a held-out log's own numbers are fitted to that log, as they say nothing of the others.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from spirob.effects import Effect
from spirob.errors import ConfigError
from spirob.machine.description.rig import NUMBERS, PER_LOG, Bounded, RigFile
from spirob.machine.inverse.scaling import Sizes, parameters
from spirob.machine.recordings.recording import Recording
from spirob.parameter import Parameter, Table

LOG_SYMBOLS = {"offset": "F", "payload": "m", "zero": "q_0"}
USUAL = ("payload", "offset")  # of which a machine has some where no log says
WIDE = 10.0  # times the effort, or what the first log carries
HEAVY = 100.0  # times the mass of a body, that its tip may carry
BESIDE = 0.3  # of a nominal number: where a second one begins


@dataclass(frozen=True)
class LogNumbers:
    """The own numbers of all logs of a rig, named `offset.LOG`, `payload.LOG`, `zero.LOG`.

    about  name -> what is known of it;  known  name -> value of those that are not fitted
    """

    about: dict[str, Parameter]
    known: dict[str, float]

    def fitted(self, logs: Sequence[str]) -> list[str]:
        """Names of the numbers of these logs that are fitted."""
        return [n for n in self.about if n not in self.known and n.partition(".")[2] in logs]


NONE = LogNumbers({}, {})


def log_numbers(rig: RigFile, recordings: Sequence[Recording], sizes: Sizes) -> LogNumbers:
    """The own numbers of the logs of these recordings, training logs first.

    A payload begins where the effort of its log says.

    What only counts against the other logs is fixed for the first one: a payload without body or
    mass counts in payloads of the first log, a position from its zero.  Raises ConfigError where
    `logs` names a log that is not there, or leaves out one that has to be given.
    """
    logs = list(dict.fromkeys(r.log for r in recordings))
    if strange := [name for name in rig.logs if name not in logs]:
        raise ConfigError(f"logs.{strange[0]}: no such log; given are {', '.join(logs)}")
    given = {kind: _given(rig, kind) for kind in PER_LOG}
    about: dict[str, Parameter] = {}
    known: dict[str, float] = {}
    for kind, values in given.items():
        own = kind in (rig.per_log or ())
        if not own and not values:
            continue
        _possible(kind, rig)
        relative = not values and (kind == "zero" or (kind == "payload" and not _at_tip(rig)))
        for k, log in enumerate(logs):
            name = f"{kind}.{log}"
            about[name] = _about(kind, rig, sizes, _heavy(recordings, log))
            if log in values:
                known[name] = values[log]
            elif relative and k == 0:
                known[name] = 1.0 if kind == "payload" else 0.0
            elif not own:
                raise ConfigError(
                    f"logs.{log}: has no {kind}; give it, or have it fitted by per_log: [{kind}]"
                )
    return LogNumbers(about, known)


def with_payload(rig: RigFile, sizes: Sizes) -> RigFile:
    """The rig with what a payload of 1 weighs and adds to the inertia to fit, where it carries one.

    A body with a tip knows both.
    """
    if "payload" not in _kinds(rig) or _at_tip(rig):
        return rig
    inertia = rig.fit.get("inertia")
    nominal = inertia.nominal if inertia else rig.known.get("inertia", 0.0)
    added: dict[str, Bounded] = {}
    if nominal > 0.0:
        added["payload_inertia"] = Bounded(
            nominal=BESIDE * nominal, low=0.0, high=WIDE**2 * nominal
        )
    if rig.position is not None:
        most, begin = WIDE * sizes.torque, BESIDE * sizes.torque
        added["payload_cosine"] = Bounded(nominal=begin, low=-most, high=most)
        if rig.angular:
            added["payload_sine"] = Bounded(nominal=begin, low=-most, high=most)
    missing = {n: b for n, b in added.items() if n not in rig.fit and n not in rig.known}
    return rig.model_copy(update={"fit": {**rig.fit, **missing}})


def _kinds(rig: RigFile) -> set[str]:
    """Which kinds of number the logs of a rig have for themselves."""
    return set(rig.per_log or ()) | {kind for kind in PER_LOG if _given(rig, kind)}


def profiled(residual: Any, names: Sequence[str], start: Mapping[str, float]) -> dict[str, float]:
    """The values of some numbers that make a residual least, by three steps of Gauss and Newton.

    residual  changes -> (N,);  start  name -> where it begins
    """
    values = dict(start)
    for _ in range(3):
        here = residual(values)
        columns = []
        for name in names:
            step = 1e-3 * max(abs(values[name]), 1.0)
            columns.append((residual({**values, name: values[name] + step}) - here) / step)
        found = np.linalg.lstsq(np.column_stack(columns), -here, rcond=None)[0]
        values |= {n: values[n] + float(x) for n, x in zip(names, found, strict=True)}
    return values


def _given(rig: RigFile, kind: str) -> dict[str, float]:
    found = {log: getattr(numbers, kind) for log, numbers in rig.logs.items()}
    return {log: float(value) for log, value in found.items() if value is not None}


def _at_tip(rig: RigFile) -> bool:
    return not isinstance(rig.body, str) and rig.body.tip is not None


def _possible(kind: str, rig: RigFile) -> None:
    hinged = not isinstance(rig.body, str)
    if kind == "payload" and hinged and not _at_tip(rig):
        raise ConfigError("per_log: payload needs body.tip, the site that carries it")
    if kind == "zero" and (hinged or rig.position is None):
        why = "a body's zero is that of its model" if hinged else "it needs the position"
        raise ConfigError(f"per_log: zero has no place here; {why}")


def _heavy(recordings: Sequence[Recording], log: str) -> float:
    """RMS of the effort of a log over that of the first one."""

    def size(name: str) -> float:
        parts = [p.effort[p.use] for r in recordings if r.log == name for p in r.pieces]
        return float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))

    return float(np.clip(size(log) / size(recordings[0].log), 1.0 / WIDE, WIDE))


def _about(kind: str, rig: RigFile, sizes: Sizes, heavy: float) -> Parameter:
    if kind == "offset":
        most, unit, nominal, low = WIDE * sizes.torque, sizes.torque_unit, 0.0, None
    elif kind == "zero":
        most, unit, nominal, low = max(sizes.stroke, 2 * np.pi), sizes.axis_unit, 0.0, None
    elif _at_tip(rig):
        most, unit, nominal, low = HEAVY * sizes.mass, "kg", heavy * sizes.mass, 0.0
    else:
        most, unit, nominal, low = HEAVY, "1", heavy, 0.0
    return Parameter(
        nominal, -most if low is None else low, most, unit, LOG_SYMBOLS[kind], PER_LOG[kind]
    )


SYMBOLS = {
    "inertia": "J",
    "viscous": "b",
    "stiffness": "k",
    "scale": "k_e",
    "delay": "δ",
    "back_emf": "k_b",
    "payload_inertia": "J_p",
    "payload_cosine": "P_c",
    "payload_sine": "P_s",
}
ABSENT = {"scale": 1.0}  # what a number is that the description does not name; the others are 0
FAMILIAR = {"N·s²/m": "kg", "N·m·s²/rad": "kg·m²"}


def table_of(
    rig: RigFile, effects: Sequence[type[Effect]], sizes: Sizes, logs: LogNumbers
) -> Table:
    """Names, bounds and values; the effects' numbers are neutral."""
    about = {f"rig.{name}": _own(rig, name, sizes) for name in NUMBERS}
    values = {f"rig.{name}": value for name, value in rig.known.items()}
    for effect in effects:
        for field, number in parameters(effect, sizes).items():
            full = f"{effect.name()}.{field}"
            about[full] = number
            declared = effect.parameters()[field]
            if field in effect.neutral:
                values[full] = effect.neutral[field] * sizes.ratio(declared.unit)
    return Table.of(about | logs.about, values | logs.known)


def cells_of(table: Table, logs: Sequence[str]) -> dict[str, list[int]]:
    """Kind of a log's own number -> its place in the table for each piece, of logs by name."""
    kinds = {n.partition(".")[0] for n in table.names} & set(PER_LOG)
    return {kind: [table.position(f"{kind}.{log}") for log in logs] for kind in kinds}


def _own(rig: RigFile, name: str, sizes: Sizes) -> Parameter:
    units = {
        "inertia": f"{sizes.torque_unit}·s²/{sizes.axis_unit}",
        "viscous": f"{sizes.torque_unit}·s/{sizes.axis_unit}",
        "stiffness": f"{sizes.torque_unit}/{sizes.axis_unit}",
        "scale": f"{sizes.torque_unit}/{sizes.effort_unit}",
        "delay": "s",
        "back_emf": f"V·s/{sizes.axis_unit}",
        "payload_inertia": f"{sizes.torque_unit}·s²/{sizes.axis_unit}",
        "payload_cosine": sizes.torque_unit,
        "payload_sine": sizes.torque_unit,
    }
    unit = FAMILIAR.get(units[name], units[name])
    chosen = rig.fit.get(name)
    value = rig.known.get(name, ABSENT.get(name, 0.0))
    low, high, nominal = value, value, value
    if chosen is not None:
        low, high, nominal = chosen.low, chosen.high, chosen.nominal
    return Parameter(nominal, low, high, unit, SYMBOLS[name], NUMBERS[name])
