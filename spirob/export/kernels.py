"""An effect's kernel with the functions that it calls, checked and named after the effect."""

import ast

from spirob.errors import ExportError
from spirob.export.corrected import Held
from spirob.export.translate import Function


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
