"""The arm for MuJoCo: as plain MJCF, and its coupled loop as a Python module beside its body.

In MJCF a winch is a slide that pulls the tendon's end away from its first guide: position x is the
tendon wound in [m], mass (G²·J_r + J_d)/r².  The tendon is a spring from its length at rest on, so
it stretches under load, and goes slack instead of pushing.

The loop is the one that `spirob.plant.assemble` generates, with two changes: MuJoCo is called
through its Python package, and where the loop steps the body it gives way to its caller.
"""

import ast
import inspect
from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np

from spirob.effects import Effect
from spirob.export.arm import CorrectedArm, lever_of, motor_of, number_of
from spirob.export.body import Machine
from spirob.export.corrected import Held
from spirob.export.law import kernel_functions, law_of
from spirob.export.native import HOLDERS
from spirob.plant.assemble import generate, law_numbers
from spirob.plant.body import build_spec
from spirob.plant.plant import CYCLE, SUBSTEPS
from spirob.plant.records import COLUMNS, NOISE
from spirob.ports import PORTS
from spirob.robot import MOTORS, Scene

AWAY = np.array([-1.0, 0.0, 0.0])  # from the base, where a winch pulls
ROOM = 0.5  # m, between a winch and the base
AT_A_WINCH = {"motor.torque", "tendon.force", "sensing.current"}
POWERS = {"N": 1, "N·m": 1, "rad": -1, "N·m·s²/rad²": 3}  # of rotor radians for a metre, by unit
Number = Callable[..., float]
ENDLESS = "10**12"
FAST = {"is_free", "chain_factor", "chain_solve", "chain_step", "bend_outline"}  # MuJoCo does it
FAST |= {"body_begins", "body_yields", "body_moves"}
LEFT_OUT = {"alone", "chain", "post", "place", "factor", "work", "bows", "heights", "outline"}
LEFT_OUT |= {"gravity", "pull", "solved"}  # of the arm's record: what only these read
ASKED = {"mode", "limit"}  # by the caller
PLAYED = ("reference", "reference_rate", "out", "angles")  # a row of each cycle: here the present
MODULE = '''"""{title}: drive, winch, tendons and effects of the arm, beside {name}.xml.

{sentence}

    controller = Controller(model)
    controller.mode[:], controller.reference[:] = VELOCITY, (0.02, 0.0)
    controller.before_step(model, data)   # ahead of each mujoco.mj_step(model, data)

SI units; columns: left, right motor; positive winds in.  One step is half a cycle of the bus.
"""

import math

import mujoco
import numpy as np

{modes}
COLUMNS = {columns}
ROW = {row}
{constants}


class Record:
    """Numbers by name."""

    def __init__(self, values):
        for name, value in values.items():
            setattr(self, name, np.array(value) if isinstance(value, list) else value)


def body_begins(arm, moved):
    """Begin a step of the arm."""
    mujoco.mj_step1(moved.model, moved.data)
    return False


def body_yields(arm, moved, untouched):
    """How the arm yields to each tendon: solved = M^-1 pull."""
    mujoco.mj_solveM(moved.model, moved.data, arm.solved, arm.pull)


{functions}


class Controller:
    """The machine round the arm; `before_step` ahead of every `mujoco.mj_step`.

    mode, reference, reference_rate, limit  (2,) what each motor follows, and its current limit [A]
    read(name)  (2,) the latest reading: one of COLUMNS
    """

    def __init__(self, model, first_angle=(0.0, 0.0)):
        self.first_angle = first_angle
        self.mode, self.limit = np.zeros(2, dtype=int), np.full(2, {limit!r})
        self.reference, self.reference_rate = np.zeros(2), np.zeros(2)
        self.reset()

    def reset(self):
        """Forget everything; begin with the data that `start` leaves."""
        self._loop, self.out = None, [Record(dict.fromkeys(ROW, 0.0)) for _ in range(2)]
        self.angles = np.zeros(len(ARM["stiffness"]))

    def start(self, model, data):
        """Put the arm where it hangs, tendons just taut."""
        mujoco.mj_resetData(model, data)
        data.qpos[: len(QPOS)] = QPOS
        self.reset()

    def read(self, name):
        """A reading of both motors, (2,)."""
        return np.array([getattr(row, name) for row in self.out])

    def before_step(self, model, data):
        """Find currents and tensions, and put them on the hinges."""
        if self._loop is None:
            state, settings, arm = Record(STATE), Record(SETTINGS), Record(ARM)
            state.first_angle[:] = self.first_angle
            settings.mode, settings.limit = self.mode, self.limit
            settings.step = model.opt.timestep
            settings.cycle = settings.substeps * settings.step
            arm.pull, arm.solved = np.zeros((2, model.nv)), np.zeros((2, model.nv))
            moved = Record(dict(model=model, data=data, qpos=data.qpos, qvel=data.qvel))
            moved.applied = data.qfrc_applied
            self._loop = run(
                P, state, Record(PASSING), settings, arm, moved, Record(dict(memory=MEMORY.copy())),
                self.reference, self.reference_rate, self.out, self.angles,
            )
        try:
            next(self._loop)
        except StopIteration:
            raise RuntimeError("the model became non-finite") from None
'''
GIVEN = ["p", "s", "w", "c", "arm", "moved", "laws", *PLAYED]


def with_tendons(
    model: CorrectedArm,
) -> tuple[Machine, list[str], dict[str, dict[str, float]]]:
    """The body with winches and tendons, names of effects that it holds, and what it leaves out.

    The last with the numbers that it has instead: tendons bend at a hinge once, effects are absent.
    """
    plant = model.plant()
    p = plant.table.vector(model.changes)
    arm, step, tip = plant.arm(p), CYCLE / SUBSTEPS, plant.tip_mass(p)
    spec = build_spec(arm, Scene(), model.rig.lengths(), step, True, tip, plant.holes(p))
    for motor in MOTORS:
        _winch(spec, motor, number_of(model, motor))
    held, outside = list[str](), dict[str, dict[str, float]]()
    if arm.bends_per_hinge != 1.0:
        outside["arm.bends_per_hinge"] = {"arm.bends_per_hinge": 1.0}
    for effect in model.effects:
        name = effect.name()
        if _holds(spec, effect, model):
            held.append(name)
        else:
            outside[name] = {f"{name}.{f}": v for f, v in effect.neutral.items()}
    begun = plant.start(Scene(), model.changes).constants()["qpos"]
    _at_rest(spec, np.asarray(begun))
    return Machine(spec, "hinge_0", ""), held, outside


def _winch(spec: mujoco.MjSpec, motor: str, number: Number) -> None:
    """A slide with the rotor's inertia and friction, its drive, and the tendon's end on it."""
    turn = number("winch.gear_ratio") / number("winch.radius", True)  # rad of the rotor for a metre
    rotor = number("motor.rotor_inertia", True) * turn**2
    drum = number("winch.drum_inertia") / number("winch.radius", True) ** 2
    first = spec.site(f"{motor}_before_0")
    body = spec.worldbody.add_body(name=f"{motor}_winch", pos=first.pos + ROOM * AWAY)
    body.explicitinertial, body.mass, body.inertia = True, rotor + drum, np.full(3, 1e-3)
    body.ipos = [0.0, 0.0, 0.0]
    body.add_site(name=f"{motor}_winch")
    slide = body.add_joint(name=f"{motor}_winch", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=AWAY)
    slide.damping = [turn**2 * number("motor.rotor_damping", True), 0.0, 0.0]
    spec.delete(spec.actuator(motor))
    drive = spec.add_actuator(
        name=motor, target=f"{motor}_winch", trntype=mujoco.mjtTrn.mjTRN_JOINT
    )
    efficiency = number("winch.efficiency", True)
    drive.gainprm[0] = efficiency * turn * number("motor.torque_constant")
    path = [wrap.target.name for wrap in spec.tendon(motor).path]
    spec.delete(spec.tendon(motor))
    tendon = spec.add_tendon(name=motor)
    for site in (f"{motor}_winch", *path):
        tendon.wrap_site(site)
    tendon.stiffness = [number("tendon.stiffness"), 0.0, 0.0]
    tendon.damping = [number("tendon.damping"), 0.0, 0.0]


def _at_rest(spec: mujoco.MjSpec, angles: np.ndarray) -> None:
    """Tendons that are just taut where the arm hangs, and a keyframe there; angles (N,) [rad]."""
    made = spec.compile()
    data = mujoco.MjData(made)
    for k, angle in enumerate(angles):
        data.joint(f"hinge_{k}").qpos[0] = angle
    mujoco.mj_fwdPosition(made, data)
    for motor in MOTORS:
        spec.tendon(motor).springlength = [0.0, float(data.tendon(motor).length[0])]
    spec.add_key(name="rest", qpos=data.qpos)


def _holds(spec: mujoco.MjSpec, effect: type[Effect], model: CorrectedArm) -> bool:
    """Put an effect into the model, where MuJoCo can hold it."""
    name, number = effect.name(), number_of(model, MOTORS[0])
    hinges = [spec.joint(f"hinge_{k}") for k in range(model.rig.units)]
    if name == "stiffness_hardening":
        for hinge in hinges:
            stiffness = float(hinge.stiffness[0])
            hinge.stiffness = [stiffness, 0.0, number(f"{name}.hardening") * stiffness]
    elif name == "rest_curvature":
        for hinge in hinges:
            hinge.springref = number(f"{name}.rest_angle")
    elif name == "mount_tilt":
        turned = [np.sin(number(f"{name}.{field}")) for field in ("pitch", "roll")]
        spec.option.gravity = spec.option.gravity + 9.80665 * np.array([*turned, 0.0])
    elif (name, effect.port) in HOLDERS and effect.port in AT_A_WINCH:
        for motor in MOTORS:
            _at_winch(spec, effect, model, motor)
    else:
        return name == "tip_payload"  # the body was built with it
    return True


def _at_winch(spec: mujoco.MjSpec, effect: type[Effect], model: CorrectedArm, motor: str) -> None:
    """An effect of the rotor, in metres of the tendon instead of radians."""
    axis, turn = motor_of(model, motor), 1.0 / lever_of(model, motor)
    axis = replace(axis, angle=1.0 / turn, rest_speed=axis.rest_speed / turn)
    (one,) = (e for e in axis.effects if e.name == effect.name())
    about = effect.parameters()
    values = {f: v * turn ** POWERS.get(about[f].unit, 0) for f, v in one.values.items()}
    machine = Machine(spec, f"{motor}_winch", "", motor)
    HOLDERS[effect.name(), effect.port](machine, replace(one, values=values), axis)


def arm_module(model: CorrectedArm, name: str, about: dict[str, str]) -> str:
    """The module beside the MJCF of an arm."""
    from spirob import control

    plant = model.plant()
    begun = plant.start(Scene(), model.changes).constants()
    looped = [e for e in model.effects if PORTS[e.port].every != "once"]
    tree = ast.parse(generate(looped, model.rig.host is not None))
    kernels = {f.node.name: f.node for e in looped for f in kernel_functions(_held(e))}
    functions = _functions(tree, kernels, plant.table.index, law_numbers(looped))
    names = f"NAMES = {tuple(plant.table.names)!r}  # of P"
    arrays = {"P": "p", "MEMORY": "memory", "QPOS": "qpos"}
    constants = [f"{n} = np.array({begun[a].tolist()!r})" for n, a in arrays.items()]
    records = {
        "STATE": _plain(begun["state"]),
        "PASSING": _plain(begun["passing"]),
        "SETTINGS": _plain(begun["settings"], ASKED),
        "ARM": _plain(begun["arm"], LEFT_OUT),
    }
    constants += [f"{n} = {values!r}" for n, values in records.items()]
    modes = {n: getattr(control, n) for n in ("CURRENT", "VELOCITY", "DISPLACEMENT", "FORCE")}
    return MODULE.format(
        name=name,
        modes="\n".join(f"{n} = {int(v)}" for n, v in modes.items()),
        columns=repr(COLUMNS),
        row=repr((*COLUMNS, NOISE)),
        constants="\n".join([names, *constants]),
        functions=functions,
        limit=20.0,
        **about,
    )


def _plain(record: np.ndarray, without: Collection[str] = ()) -> dict[str, Any]:
    return {n: record[n].tolist() for n in record.dtype.names or () if n not in without}


def _held(effect: type[Effect]) -> Held:
    text = inspect.getsource(inspect.getmodule(effect))  # type: ignore[arg-type]
    return Held(law_of(effect.name(), text, effect), {})


def _functions(
    tree: ast.Module,
    kernels: dict[str, ast.FunctionDef],
    places: dict[str, int],
    of_laws: list[str],
) -> str:
    """The functions of the generated loop as plain Python, kernels as they were checked."""
    found = [n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name not in FAST]
    made: list[ast.FunctionDef] = []
    for node in found:
        if node.name in kernels:
            continue
        node.decorator_list = []
        stepped = _Loop().visit(node) if node.name == "run" else node
        made.append(_Step(places, of_laws).visit(stepped))
    made = [*kernels.values(), *made]
    for node in made:
        ast.fix_missing_locations(node)
    return "\n\n\n".join(ast.unparse(node) for node in made)


class _Step(ast.NodeTransformer):
    """Numbers by their place in the vector, which whoever takes it home may change."""

    def __init__(self, places: dict[str, int], of_laws: list[str]):
        self.places = places
        self.of_laws = of_laws

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        owner, _, name = ast.unparse(node).partition(".")
        if owner == "p" and name in self.places:
            return self._number(name)
        return node

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        if ast.unparse(node.value) == "laws.numbers":
            return self._number(self.of_laws[ast.literal_eval(node.slice)])
        return self.generic_visit(node)

    def _number(self, name: str) -> ast.AST:
        return ast.parse(f"p[{self.places[name]}]", mode="eval").body


class _Loop(ast.NodeTransformer):
    """`run` as a generator that a caller steps."""

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        node.args.args = [ast.arg(name) for name in GIVEN]
        self.generic_visit(node)
        return node

    def visit_Assign(self, node: ast.Assign) -> ast.AST | None:
        names = ast.unparse(node.targets[0])
        if names.startswith(("p,", "(p,")):  # they come as they are
            return None
        if names == "cycles":
            return ast.parse(f"cycles = {ENDLESS}").body[0]
        return self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> ast.AST:
        if ast.unparse(node.value).startswith("body_moves("):
            return ast.parse("yield").body[0]
        return self.generic_visit(node)

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        self.generic_visit(node)
        rows = isinstance(node.slice, ast.Tuple) and ast.unparse(node.slice.elts[0]) == "cycle"
        if rows and ast.unparse(node.value) in PLAYED:
            node.slice = node.slice.elts[1]  # type: ignore[attr-defined]
        return node
