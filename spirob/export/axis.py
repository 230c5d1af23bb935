"""The equations of a plain axis as one text of plain arithmetic, from which C and Python are made.

    compensate  effort that a motion asks for: the inverse model of `spirob.machine.asked`, one
                sample after the other, with its memory in a state
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
from spirob.export.corrected import Corrected, Held
from spirob.export.translate import HELP, Function

PASSES = 12  # of the solution for the effort before the drive's pipes, as `asked.PASSES`
SENSED = 10  # of that for the effort behind its sensor, as `forward.torque.PASSES`
ADDED, BEFORE = ("motor.torque", "tendon.force"), ("command.current", "motor.drive_torque")
HINGE, SENSOR, SHARE = "body.hinge_torque", "sensing.displacement", "winch.efficiency"
CURRENT, REPORT, FRAME = "sensing.current", "sensing.report", "sensing.frame"
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
    "hinge.angle": "q",
    "hinge.speed": "v",
    "hinge.stiffness": "HINGE_STIFFNESS",
    "hinge.weight_x": "s.weight_x",
    "hinge.weight_y": "s.weight_y",
}
GIVEN = {  # fields of the state that the caller sets
    "time": "s, since the motion began",
    "carried": "what the axis carries beside its own inertia and spring",
    "payload": "payload, in the unit of the diagnosis",
    "offset": "torque or force that this motion needs beside",
    "weight_x": "torque of the weight if gravity pointed along +x",
    "weight_y": "the same along +y",
}
COMPENSATE = '''
def compensate(s, position, speed, acceleration, dt):
    """Effort to command so that the axis moves so; call it once for each step of a motion."""
    q = position
    v = speed
    a = acceleration
    effort = 0.0
{behind}
    load = loaded(s, q, a)
{hinge}
    slow = a
{ahead}
    needed = load + VISCOUS * v + s.offset + OWN_INERTIA * a + {share} * INERTIA * (a - slow)
{added}
    wanted = needed / SCALE
    effort = wanted
{solved}
    effort = effort + BACK_EMF * v
{current}
    s.time = s.time + dt
    return effort
'''
LOADED = '''
def loaded(s, q, a):
    """What the transmission passes on, without effects."""
    return INERTIA * a + STIFFNESS * q + s.carried
'''
WITH_PAYLOAD = '''
def loaded(s, q, a):
    """What the transmission passes on, without effects."""
    weight = PAYLOAD_COSINE * math.cos({turned}) + PAYLOAD_SINE * math.sin({turned})
    own = INERTIA * a + STIFFNESS * q
    return own + s.payload * (PAYLOAD_INERTIA * a + weight) + s.carried
'''
TORQUE = '''
def torque(s, position, speed, acceleration, effort, dt):
    """What drive and effects put on the axis, friction negative, at this effort."""
    q = position
    v = speed
    load = loaded(s, q, acceleration)
    held = 0.0
{held}
    load = load - held
{sensor}
    effort = effort - BACK_EMF * v
    passed = effort
{pipes}
    share = 1.0
{shares}
    out = SCALE * share * passed + held
{added}
    s.time = s.time + dt
    return out
'''
REPORTED = '''
def reported(s, effort, dt):
    """The effort as the drive reports it; call it once for each step of a log."""
{report}
    return effort
'''
FRAMED = '''
def framed(s, effort, dt):
    """The effort in a frame as late as the bus brings it; call it once for each cycle."""
{frame}
    return effort
'''
MISREAD = '''
def misread(q, v):
    """Error of the position sensor at this position."""
    error = 0.0
{errors}
    return error
'''
SEEN = '''
def seen(s, position, load):
    """The position as its sensor reads it, under this load."""
    q = position
    v = 0.0
    effort = 0.0
    error = 0.0
{errors}
    return q + error
'''
BEHIND = '''
def behind(q, v, a, dt):
    """Position, speed and acceleration without the errors of the position sensor."""
    here = misread(q, v)
    later = misread(q + v * dt + 0.5 * a * dt * dt, v)
    sooner = misread(q - v * dt + 0.5 * a * dt * dt, v)
    first = (later - sooner) / (2.0 * dt)
    second = (later - 2.0 * here + sooner) / (dt * dt)
    return q - here, v - first, a - second
'''
AHEAD = """\
    error = 0.0
{errors}
    first = 0.0
    second = 0.0
    if s.rows >= 1.0:
        first = (error - s.error_1) / dt
    if s.rows >= 2.0:
        first = (3.0 * error - 4.0 * s.error_1 + s.error_2) / (2.0 * dt)
        second = (error - 2.0 * s.error_1 + s.error_2) / (dt * dt)
    if s.rows >= 3.0:
        second = (2.0 * error - 5.0 * s.error_1 + 4.0 * s.error_2 - s.error_3) / (dt * dt)
    s.error_3 = s.error_2
    s.error_2 = s.error_1
    s.error_1 = error
    s.rows = min(s.rows + 1.0, 3.0)
    q = q - error
    v = v - first
    a = a - second"""
SOLVED = """\
    step = 1.0
    missed = 1e300
    moved = 0.0
    edge = 0.0
    for turn in range({passes}):
        passed = effort
{pipes}
        share = 1.0
{shares}
        miss = wanted - share * passed
        if abs(miss) <= 1e-12 * abs(wanted):
            break
        flat = miss * missed > 0.0 and abs(miss) > 0.5 * abs(missed)
        slope = 1.0
        if missed - miss != 0.0:
            slope = moved / (missed - miss)
        if flat:
            edge = 1.0
            step = 2.0 * step
        else:
            step = 1.0
            if edge == 0.0 and slope > 0.5 and slope < 2.0:
                step = slope
        moved = step * miss
        missed = miss
        effort = effort + moved
{kept}"""


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

    @property
    def helpers(self) -> str:
        """What the functions in C need beside `math.h`."""
        return HELP


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


def kernel_functions(one: Held) -> list[Function]:
    """An effect's kernel and the functions of its file that it calls, those first."""
    law, found = one.law, dict[str, Function]()
    who = f"effect '{one.name}'"

    def follow(node: ast.FunctionDef, name: str, above: tuple[str, ...]) -> None:
        called = [
            n.func.id
            for n in ast.walk(node)
            if isinstance(n, ast.Call) and isinstance(n.func, ast.Name) and n.func.id in law.helpers
        ]
        for helper in dict.fromkeys(called):
            if helper in above:
                raise ExportError(f"{who}: its kernel calls itself, which cannot leave")
            if f"{one.name}_{helper}" not in found:
                follow(law.helpers[helper], f"{one.name}_{helper}", (*above, helper))
        renamed = _renamed(node, name, one)
        known = {f"{one.name}_{h}": found[f"{one.name}_{h}"].values for h in called}
        found[name] = Function(who, renamed, known)

    follow(law.kernel, kernel_name(one), ())
    return list(found.values())


def kernel_name(one: Held) -> str:
    """What its kernel is called in what is exported."""
    return f"kernel_{one.name}"


class _Rename(ast.NodeTransformer):
    """Helpers by the effect's name, constants by their value, no annotations."""

    def __init__(self, one: Held):
        self.one, self.own = one, set[str]()

    def visit_Name(self, node: ast.Name) -> ast.AST:
        law = self.one.law
        if node.id in law.helpers:
            return ast.copy_location(ast.Name(f"{self.one.name}_{node.id}", node.ctx), node)
        if node.id in law.constants and node.id not in self.own and isinstance(node.ctx, ast.Load):
            return ast.copy_location(ast.Constant(law.constants[node.id]), node)
        return node


def _renamed(node: ast.FunctionDef, name: str, one: Held) -> ast.FunctionDef:
    copied = ast.parse(ast.unparse(node)).body[0]
    assert isinstance(copied, ast.FunctionDef)
    rename = _Rename(one)
    rename.own = {a.arg for a in copied.args.args}
    copied.body = [rename.visit(statement) for statement in copied.body]
    copied.name, copied.decorator_list, copied.returns = name, [], None
    for argument in copied.args.args:
        argument.annotation = None
    return ast.fix_missing_locations(copied)


def _constants(model: Corrected) -> dict[str, float]:
    found = {name.upper(): value for name, value in model.numbers.items()}
    found |= {"REST_SPEED": model.rest_speed, "ANGLE": model.angle}
    found |= {"HINGE_STIFFNESS": model.stiffness, "OWN_INERTIA": model.own_inertia}
    for one in model.effects:
        found |= {number_name(one, field): value for field, value in one.values.items()}
    return found


def number_name(one: Held, field: str) -> str:
    """What a number of an effect is called in what is exported."""
    return f"{one.name}_{field}".upper()


def _state(model: Corrected) -> dict[str, float]:
    found = dict.fromkeys(GIVEN, 0.0)
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
    ahead = AHEAD.format(errors=_calls(twisted, "+error", upstream="q")) if twisted else ""
    frame = _calls(model.at(FRAME), "effort")
    compensate = COMPENSATE.format(
        behind="    q, v, a = behind(q, v, a, dt)" if wrong else "",
        hinge=_calls(model.at(HINGE), "-load"),
        ahead=ahead,
        share=repr(max(shares, default=0.0)),
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
    errors = _calls(wrong, "+error", upstream="q")
    turned = "q" if model.axis == "rad" else "0.0"
    carries = any(model.numbers[n] for n in model.numbers if n.startswith("payload"))
    texts = [(WITH_PAYLOAD.format(turned=turned) if carries else LOADED, "s")]
    texts += [(MISREAD.format(errors=errors), ""), (BEHIND, "")] if wrong else []
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
