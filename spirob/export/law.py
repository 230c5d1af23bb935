"""An effect as its file states it, read without running the file: where it acts, and its kernel.

An effect's file is a program.  Only its declaration and its kernel are wanted here, so the text is
parsed and nothing in it is run.

`kernel_functions` are its kernel and what that calls, checked and named after the effect.
"""

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from spirob.effects import Effect
from spirob.errors import ExportError
from spirob.export.translate import Function
from spirob.ports import PORTS, SIGNALS

if TYPE_CHECKING:
    from spirob.export.corrected import Held


Declared = tuple[str, dict[str, Any], dict[str, float], dict[str, float], tuple[str, ...]]


@dataclass(frozen=True)
class Law:
    """What an export needs of an effect.

    numbers   names of its numbers, in order;  state  memory -> what it begins with
    neutral   numbers at which it is absent
    kernel    its function;  helpers, constants  of the same file, that a kernel may use
    """

    name: str
    port: str
    reads: dict[str, str]
    state: dict[str, float]
    neutral: dict[str, float]
    numbers: tuple[str, ...]
    kernel: ast.FunctionDef
    helpers: dict[str, ast.FunctionDef]
    constants: dict[str, float]

    @property
    def pipe(self) -> bool:
        """Whether it maps the value from upstream instead of adding to it."""
        return PORTS[self.port].combine == "pipe"

    @property
    def arguments(self) -> list[str]:
        """The kernel's arguments in order."""
        return [a.arg for a in self.kernel.args.args]


def law_of(name: str, text: str, effect: type[Effect] | None = None) -> Law:
    """The law in the text of an effect's file.

    effect  the same where it is known to the program, which then states its declaration

    Raises ExportError where the text declares no effect that can be read as plain data.
    """
    who = f"effect '{name}'"
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError):
        raise ExportError(f"{who}: its file is no Python that can be read") from None
    classes = [n for n in tree.body if isinstance(n, ast.ClassDef) and _is_effect(n)]
    if len(classes) != 1:
        raise ExportError(f"{who}: its file declares {len(classes)} effects, one is needed")
    body = classes[0].body
    kernels = [n for n in body if isinstance(n, ast.FunctionDef) and n.name == "kernel"]
    if len(kernels) != 1:
        raise ExportError(f"{who}: its file defines no kernel")
    port, reads, state, neutral, numbers = _declared(body, who) if effect is None else _told(effect)
    helpers = {n.name: n for n in tree.body if isinstance(n, ast.FunctionDef)}
    constants = dict(_constants(tree))
    law = Law(name, port, reads, state, neutral, numbers, kernels[0], helpers, constants)
    _checked(law, who)
    return law


def _told(effect: type[Effect]) -> Declared:
    return (
        effect.port,
        dict(effect.reads),
        dict(effect.state),
        dict(effect.neutral),
        tuple(effect.parameters()),
    )


def _declared(body: list[ast.stmt], who: str) -> Declared:
    said = {k: v for node in body for k, v in _assigned(node)}
    return (
        str(_plain(said.get("port"), who, "port", "")),
        _mapping(said.get("reads"), who, "reads"),
        {k: float(v) for k, v in _mapping(said.get("state"), who, "state").items()},
        {k: float(v) for k, v in _mapping(said.get("neutral"), who, "neutral").items()},
        tuple(n.target.id for n in body if _is_number(n)),  # type: ignore[attr-defined]
    )


def _is_effect(node: ast.ClassDef) -> bool:
    return any(ast.unparse(base).rpartition(".")[2] == "Effect" for base in node.bases)


def _assigned(node: ast.stmt) -> list[tuple[str, ast.expr]]:
    if isinstance(node, ast.Assign):
        return [(t.id, node.value) for t in node.targets if isinstance(t, ast.Name)]
    if isinstance(node, ast.AnnAssign) and node.value and isinstance(node.target, ast.Name):
        return [(node.target.id, node.value)]
    return []


def _is_number(node: ast.stmt) -> bool:
    """Whether a line of the class declares a number, by `bounded(...)`."""
    made = isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)
    call = node.value if isinstance(node, ast.AnnAssign) else None
    return made and isinstance(call, ast.Call) and ast.unparse(call.func).endswith("bounded")


def _plain(node: ast.expr | None, who: str, what: str, absent: Any) -> Any:
    if node is None:
        return absent
    try:
        return ast.literal_eval(node)
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        raise ExportError(f"{who}: its '{what}' is no plain value, so it cannot leave") from None


def _mapping(node: ast.expr | None, who: str, what: str) -> dict[str, Any]:
    found = _plain(node, who, what, {})
    if not isinstance(found, dict) or not all(isinstance(k, str) for k in found):
        raise ExportError(f"{who}: its '{what}' is no mapping of names")
    return found


def _constants(tree: ast.Module) -> list[tuple[str, float]]:
    pairs = [pair for node in tree.body for pair in _assigned(node)]
    return [
        (name, float(value.value))
        for name, value in pairs
        if isinstance(value, ast.Constant) and isinstance(value.value, int | float)
    ]


def _checked(law: Law, who: str) -> None:
    if law.port not in PORTS:
        raise ExportError(f"{who}: its port '{law.port}' is none")
    if unknown := [s for s in law.reads.values() if s not in SIGNALS]:
        raise ExportError(f"{who}: it reads '{unknown[0]}', which is no signal")
    given = [*(["upstream"] if law.pipe else []), *law.reads, *law.state, *law.numbers, "dt"]
    if strange := [a for a in law.arguments if a not in given]:
        raise ExportError(f"{who}: nothing gives its kernel '{strange[0]}'")


def kernel_functions(one: "Held") -> list[Function]:
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


def kernel_name(one: "Held") -> str:
    """What its kernel is called in what is exported."""
    return f"kernel_{one.name}"


class _Rename(ast.NodeTransformer):
    """Helpers by the effect's name, constants by their value, no annotations."""

    def __init__(self, one: "Held"):
        self.one, self.own = one, set[str]()

    def visit_Name(self, node: ast.Name) -> ast.AST:
        law = self.one.law
        if node.id in law.helpers:
            return ast.copy_location(ast.Name(f"{self.one.name}_{node.id}", node.ctx), node)
        if node.id in law.constants and node.id not in self.own and isinstance(node.ctx, ast.Load):
            return ast.copy_location(ast.Constant(law.constants[node.id]), node)
        return node


def _renamed(node: ast.FunctionDef, name: str, one: "Held") -> ast.FunctionDef:
    copied = ast.parse(ast.unparse(node)).body[0]
    assert isinstance(copied, ast.FunctionDef)
    rename = _Rename(one)
    rename.own = {a.arg for a in copied.args.args}
    copied.body = [rename.visit(statement) for statement in copied.body]
    copied.name, copied.decorator_list, copied.returns = name, [], None
    for argument in copied.args.args:
        argument.annotation = None
    return ast.fix_missing_locations(copied)
