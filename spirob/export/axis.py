"""The equations of a plain axis as one text of plain arithmetic, from which C and Python are made.

    compensate  effort that a motion asks for, by `spirob.machine.inverse.equations`, one sample
                after the other, with its memory in a state
    torque      what drive and effects put on the axis at an effort: `spirob.machine.forward`
    reported    an effort as the drive reports it;  framed  as late as the bus brings it
    seen        a position as its sensor reads it

Ports follow each other as they do there.  Kernels are pasted, so they are the library's.
"""

import ast
import re
from collections.abc import Sequence
from dataclasses import dataclass

from spirob.errors import ExportError
from spirob.export.axis_text import (
    AHEAD,
    BEHIND,
    COMPENSATE,
    FRAMED,
    LOADED,
    MISREAD,
    MOTOR,
    REPORTED,
    SEEN,
    SOLVED,
    TORQUE,
    WITH_PAYLOAD,
)
from spirob.export.corrected import Corrected, Held
from spirob.export.law import kernel_functions, kernel_name
from spirob.export.translate import Function
from spirob.machine.forward.torque import PASSES as SENSED
from spirob.machine.inverse.equations import ADDED, BEFORE, HINGE, READINGS, SENSOR
from spirob.machine.inverse.kernel_loop import PASSES

CURRENT, REPORT, FRAME = "sensing.current", "sensing.report", "sensing.frame"
SHARE = "winch.efficiency"
PLAYED = {*ADDED, *BEFORE, HINGE, SENSOR, SHARE, CURRENT, REPORT, FRAME}
BUILT = "body.tip_mass"  # is part of the body
# constants that a controller reads
HARD = frozenset({"INERTIA", "VISCOUS", "STIFFNESS", "SCALE", "BACK_EMF", "REST_SPEED"})
EMPTY = re.compile(r"^ *pass\n", re.MULTILINE)
SIGNALS = {
    "time": "s.time",
    "motor.rest_speed": "REST_SPEED",
    "motor.speed": "v",
    "motor.angle": "(q / ANGLE)",
    "motor.current": "effort",
    "motor.command": "effort",
    "motor.load_torque": "load",
    "motor.inertia_torque": "(LOAD_INERTIA * a)",
    "winch.displacement": "q",
    "hinge.angle": "q",
    "hinge.speed": "v",
    "hinge.stiffness": "HINGE_STIFFNESS",
    "hinge.weight_x": "s.weight_x",
    "hinge.weight_y": "s.weight_y",
}
GIVEN = {  # fields of the state that the caller sets
    "time": "s, since the motion began",
    "carried": "what the axis carries beside its own inertia and spring",
    "payload": "payload, in the unit of the diagnosis; begins with the mean of its logs",
    "offset": "torque or force that the motion needs beside; begins the same way",
    "weight_x": "torque of the weight if gravity pointed along +x",
    "weight_y": "the same along +y",
}


@dataclass(frozen=True)
class Equations:
    """The equations of one axis.

    constants  name -> value;  state  field -> what it begins with;  python  text of all functions
    functions  the same, checked, each with its text in C
    """

    constants: dict[str, float]
    state: dict[str, float]
    python: str
    functions: tuple[Function, ...]


def equations(model: Corrected) -> Equations:
    """The equations of a corrected axis.

    Raises ExportError for an effect that has no place on an axis or whose kernel cannot leave.
    """
    if strange := [e for e in model.effects if e.law.port not in {*PLAYED, BUILT}]:
        raise ExportError(
            f"effect '{strange[0].name}' acts at {strange[0].law.port}, which an axis has not"
        )
    if unread := [(e, s) for e in model.effects for s in e.law.reads.values() if s not in SIGNALS]:
        effect, signal = unread[0]
        raise ExportError(f"effect '{effect.name}' reads {signal}, which an axis has not")
    constants = _constants(model)
    given = frozenset(constants)
    nodes, known = [], {}
    for one in (e for e in model.effects if e.law.port != BUILT):
        for function in kernel_functions(one):
            nodes.append(function)
            known[function.node.name] = function.values
    for text, state in _texts(model):
        node = ast.parse(EMPTY.sub("", text)).body[0]
        assert isinstance(node, ast.FunctionDef)
        nodes.append(Function("axis", node, dict(known), given, state))
        known[node.name] = nodes[-1].values
    python = "\n\n\n".join(ast.unparse(f.node) for f in nodes)
    used = set().union(*(f.read for f in nodes))
    kept = {name: value for name, value in constants.items() if name in used | HARD}
    return Equations(kept, _state(model), python, tuple(nodes))


def _constants(model: Corrected) -> dict[str, float]:
    found = {name.upper(): value for name, value in model.numbers.items()}
    found |= {"REST_SPEED": model.rest_speed, "ANGLE": model.angle}
    inertia = model.numbers["inertia"]  # the motor's alone where a body carries the rest
    ahead, behind = (inertia, 0.0) if model.body else (0.0, inertia)
    found |= {"HINGE_STIFFNESS": model.stiffness, "LOAD_INERTIA": behind}
    found |= {"OWN_INERTIA": model.own_inertia + ahead}
    for one in model.effects:
        found |= {number_name(one, field): value for field, value in one.values.items()}
    return found


def number_name(one: Held, field: str) -> str:
    """What a number of an effect is called in what is exported."""
    return f"{one.name}_{field}".upper()


def _state(model: Corrected) -> dict[str, float]:
    found = dict.fromkeys(GIVEN, 0.0) | {"offset": model.usual["offset"]}
    if model.body is None:  # else it is a part of the body
        found["payload"] = model.usual["payload"]
    for one in model.effects:
        found |= {f"{one.name}_{name}": value for name, value in one.law.state.items()}
    if any(feels_load(e) for e in model.at(SENSOR)):
        found |= dict.fromkeys(("rows", "error_1", "error_2", "error_3"), 0.0)
    return found


def feels_load(one: Held) -> bool:
    """Whether an error of the reading is a twist under the load."""
    return "motor.load_torque" in one.law.reads.values()


def _texts(model: Corrected) -> list[tuple[str, str]]:
    """The functions of the axis, each with the name of its state, in the order of their use."""
    sensors = model.at(SENSOR)
    wrong = [e for e in sensors if not feels_load(e)]
    twisted = [e for e in sensors if feels_load(e)]
    for one in wrong:
        if one.law.state or {"motor.current", "motor.command", "time"} & set(
            one.law.reads.values()
        ):
            raise ExportError(f"effect '{one.name}': an error of the position with memory stays")
    shares = [e.values["rotor_share"] for e in twisted if "rotor_share" in e.values]
    all_ahead = not twisted or model.body is not None
    share = repr(1.0 if all_ahead else max(shares, default=0.0))
    sensed = {
        "behind": "    q, v, a = behind(q, v, a, dt)" if wrong else "",
        "hinge": _calls(model.at(HINGE), "-load"),
        "ahead": AHEAD.format(errors=_calls(twisted, "+error", upstream="q")) if twisted else "",
        "share": share,
    }
    frame = _calls(model.at(FRAME), "effort")
    compensate = COMPENSATE.format(
        **sensed,
        added=_calls(_several(model, ADDED), "-needed"),
        solved=_solved(model),
        current=_calls(model.at(CURRENT), "effort"),
    )
    torque = TORQUE.format(
        held=_calls(model.at(HINGE), "+held"),
        sensor=_sensor(model),
        pipes=_calls(_several(model, BEFORE), "passed"),
        shares=_calls(model.at(SHARE), "share"),
        added=_calls(_several(model, ADDED), "+out"),
    )
    errors = _calls(wrong, "+error", pad=8 * " ", upstream="q")
    turned = "q" if model.axis == "rad" else "0.0"
    carries = any(model.numbers[n] for n in model.numbers if n.startswith("payload"))
    texts = [(WITH_PAYLOAD.format(turned=turned) if carries else LOADED, "s")]
    texts += [(MISREAD.format(errors=errors, readings=READINGS), ""), (BEHIND, "")] if wrong else []
    texts += [(MOTOR.format(**sensed), "s")] if sensors else []
    texts += [(compensate, "s"), (torque, "s")]
    texts += [(REPORTED.format(report=_calls(model.at(REPORT), "effort")), "s")]
    texts += [(FRAMED.format(frame=frame), "s")]
    texts += [(SEEN.format(errors=_calls(sensors, "+error", upstream="q")), "s")]
    return texts


def _several(model: Corrected, ports: Sequence[str]) -> list[Held]:
    return [e for port in ports for e in model.at(port)]


def _solved(model: Corrected) -> str:
    pipes, shares = _several(model, BEFORE), model.at(SHARE)
    if not pipes and not shares:
        return ""
    return SOLVED.format(
        passes=PASSES,
        pipes=_calls(pipes, "passed", "        ", held=True),
        shares=_calls(shares, "share", "        ", held=True),
        kept=_kept([*pipes, *shares]),
    )


def _sensor(model: Corrected) -> str:
    """Lines that find the effort at which the drive's sensor reads the one that is wanted."""
    pipes = model.at(CURRENT)
    if not pipes:
        return ""
    lines = ["    wanted = effort", f"    for turn in range({SENSED}):", "        passed = effort"]
    lines += [_calls(pipes, "passed", "        ", held=True)]
    lines += ["        effort = effort + wanted - passed", _kept(pipes)]
    return "\n".join(lines)


def _kept(effects: Sequence[Held]) -> str:
    """Lines that remember what the last pass left."""
    fields = [f"{e.name}_{name}" for e in effects for name in e.law.state]
    return "\n".join(f"    s.{field} = next_{field}" for field in fields)


def _calls(
    effects: Sequence[Held],
    into: str,
    pad: str = "    ",
    upstream: str = "",
    held: bool = False,
) -> str:
    """Lines that call kernels.

    into      variable that a pipe maps, or with a sign to which the contribution is added
    upstream  what a pipe is given, where only its error is wanted
    held      memory is written to `next_...`, to be kept once the passes are done
    """
    lines = []
    for one in effects:
        law, target = one.law, into.lstrip("+-")
        places = {"upstream": upstream or target, "dt": "dt"}
        places |= {a: SIGNALS[signal] for a, signal in law.reads.items()}
        places |= {name: f"s.{one.name}_{name}" for name in law.state}
        places |= {name: number_name(one, name) for name in law.numbers}
        call = f"{kernel_name(one)}({', '.join(places[a] for a in law.arguments)})"
        stored = [f"{'next_' if held else 's.'}{one.name}_{name}" for name in law.state]
        plain = into == target
        first = target if plain else "more"
        lines.append(f"{', '.join([first, *stored])} = {call}")
        if not plain:
            more = f"(more - {upstream})" if upstream else "more"
            lines.append(f"{target} = {target} {into[0]} {more}")
    return "\n".join(pad + line for line in lines) or f"{pad}pass"
