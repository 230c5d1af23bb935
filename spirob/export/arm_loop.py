"""The coupled loop of the arm as a Python module for plain MuJoCo.

It is the loop that `spirob.plant.assemble` generates, with two changes: MuJoCo is called through
its Python package, and where the loop steps the body it gives way to its caller.
"""

import ast
import inspect

import numpy as np

from spirob.effects import Effect
from spirob.export.arm import CorrectedArm
from spirob.export.corrected import Held
from spirob.export.law import kernel_functions, law_of
from spirob.plant.assemble import generate
from spirob.plant.plant import COLUMNS
from spirob.ports import PORTS
from spirob.robot import Scene

ENDLESS = "10**12"
STEPPED = {
    "mj_step1": "mujoco.mj_step1(model, data)",
    "mj_solveM": "mujoco.mj_solveM(model, data, solved, pull)",
}
FAST = {"is_free", "chain_factor", "chain_solve", "chain_step", "bend_outline"}  # MuJoCo does it
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
{constants}


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
        self._loop, self.out = None, np.zeros((2, len(COLUMNS)))
        self.angles = np.zeros(GUIDES.shape[1])

    def start(self, model, data):
        """Put the arm where it hangs, tendons just taut."""
        mujoco.mj_resetData(model, data)
        data.qpos[: len(QPOS)] = QPOS
        self.reset()

    def read(self, name):
        """A reading of both motors, (2,)."""
        return self.out[:, COLUMNS.index(name)].copy()

    def before_step(self, model, data):
        """Find currents and tensions, and put them on the hinges."""
        if self._loop is None:
            state = STATE.copy()
            state[{first_row}] = self.first_angle
            pull = np.zeros((2, model.nv))
            self._loop = run(
                model, data, data.qpos, data.qvel, data.qfrc_applied, P, self.mode, self.reference,
                self.reference_rate, self.limit, GAINS, GUIDES, UNITS, GRAVITY, STIFFNESS,
                {substeps}, model.opt.timestep, {drive_steps}, state, MEMORY.copy(), pull,
                np.zeros_like(pull), self.out, self.angles,
            )
        try:
            next(self._loop)
        except StopIteration:
            raise RuntimeError("the model became non-finite") from None
'''
GIVEN = [
    "model", "data", "qpos", "qvel", "applied", "p", "mode", "reference", "reference_rate", "limit",
    "gains", "guides", "units", "gravity", "stiffness", "substeps", "step", "drive_steps", "state",
    "memory", "pull", "solved", "out", "angles",
]  # fmt: skip


def arm_module(model: CorrectedArm, name: str, about: dict[str, str]) -> str:
    """The module beside the MJCF of an arm."""
    from spirob.control import law
    from spirob.plant.plant import FIRST_ANGLE, SUBSTEPS

    plant = model.plant()
    begun = plant.start(Scene(), model.changes).constants()
    looped = [e for e in model.effects if PORTS[e.port].every != "once"]
    tree = ast.parse(generate(looped, plant.table.names, model.rig.host is not None))
    kernels = {f.node.name: f.node for e in looped for f in kernel_functions(_held(e))}
    functions = _functions(tree, kernels)
    names = f"NAMES = {tuple(plant.table.names)!r}  # of P"
    arrays = {"QPOS": "qpos", "P": "p", "GAINS": "gains", "GUIDES": "guides", "UNITS": "units"}
    arrays |= {"GRAVITY": "gravity", "STIFFNESS": "stiffness", "STATE": "state", "MEMORY": "memory"}
    constants = [f"{n} = np.array({_plain(begun[a])})" for n, a in arrays.items()]
    modes = {n: getattr(law, n) for n in ("CURRENT", "VELOCITY", "DISPLACEMENT", "FORCE")}
    return MODULE.format(
        name=name,
        modes="\n".join(f"{n} = {int(v)}" for n, v in modes.items()),
        columns=repr(COLUMNS),
        constants="\n".join([names, *constants]),
        functions=functions,
        limit=20.0,
        first_row=FIRST_ANGLE,
        substeps=SUBSTEPS,
        drive_steps=int(begun["drive_steps"]),
        **about,
    )


def _plain(values: np.ndarray) -> str:
    return repr(values.tolist())


def _held(effect: type[Effect]) -> Held:
    text = inspect.getsource(inspect.getmodule(effect))  # type: ignore[arg-type]
    return Held(law_of(effect.name(), text, effect), {})


def _functions(tree: ast.Module, kernels: dict[str, ast.FunctionDef]) -> str:
    """The functions of the generated loop as plain Python, kernels as they were checked."""
    found = [n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name not in FAST]
    made: list[ast.FunctionDef] = []
    for node in found:
        if node.name in kernels:
            continue
        node.decorator_list = []
        made.append(_Loop().visit(node) if node.name == "run" else node)
    made = [*kernels.values(), *made]
    for node in made:
        ast.fix_missing_locations(node)
    return "\n\n\n".join(ast.unparse(node) for node in made)


class _Loop(ast.NodeTransformer):
    """`run` as a generator that a caller steps."""

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        node.args.args = [ast.arg(name) for name in GIVEN]
        self.generic_visit(node)
        return node

    def visit_Assign(self, node: ast.Assign) -> ast.AST | None:
        names = ast.unparse(node.targets[0])
        if names in ("alone", "untouched") or names.startswith(("place,", "(place,")):
            return None
        if names == "cycles":
            return ast.parse(f"cycles = {ENDLESS}").body[0]
        return self.generic_visit(node)

    def visit_If(self, node: ast.If) -> ast.AST | list[ast.stmt] | None:
        test = ast.unparse(node.test)
        if test.startswith("bows"):
            return None
        if test == "untouched":
            kept = [self.visit(statement) for statement in node.orelse]
            return [x for part in kept for x in (part if isinstance(part, list) else [part]) if x]
        return self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> ast.AST:
        called = ast.unparse(node.value).partition("(")[0]
        if called == "mj_step2":
            return ast.parse("yield").body[0]
        if called in STEPPED:
            return ast.parse(STEPPED[called]).body[0]
        return self.generic_visit(node)

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        self.generic_visit(node)
        rows = isinstance(node.slice, ast.Tuple) and ast.unparse(node.slice.elts[0]) == "cycle"
        if rows and ast.unparse(node.value) in PLAYED:
            left = node.slice.elts[1:]  # type: ignore[attr-defined]
            node.slice = left[0] if len(left) == 1 else ast.Tuple(left, ast.Load())
        return node
