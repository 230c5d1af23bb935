"""A kernel is a formula: whatever numbers it is given, it comes to an end.

It runs inside the search, at numbers that nobody has tried before, so its text has to show that it
ends: no `while`, loops only over `range` of numbers that stand there, no function that calls
itself, and no call of anything that is not known to end.  `open_end` tells what does not.
"""

import ast
import builtins
import inspect
import math
import textwrap
from collections.abc import Callable, Iterator
from types import FunctionType
from typing import Any

import numpy as np

MOST = 1000  # turns of a loop and of those around it, together
PLAIN = {"abs", "bool", "float", "int", "len", "max", "min", "range", "round"}
TABLES = {"array", "clip", "interp", "zeros_like"}  # of NumPy, beside its functions of a number
WHOLE = {"comb", "factorial", "perm"}  # of `math`: as long as their argument is large
PARTS = (
    ast.arguments, ast.arg, ast.Expr, ast.Assign, ast.AugAssign, ast.AnnAssign,
    ast.If, ast.For, ast.Break, ast.Continue, ast.Pass, ast.Return, ast.Assert, ast.Raise,
    ast.Constant, ast.Name, ast.Attribute, ast.Subscript, ast.Slice, ast.Tuple, ast.List, ast.Call,
    ast.BinOp, ast.UnaryOp, ast.BoolOp, ast.Compare, ast.IfExp,
    ast.operator, ast.unaryop, ast.boolop, ast.cmpop, ast.expr_context,
)  # fmt: skip
SAID = "a kernel is a formula: arithmetic, `if`, loops over `range` of numbers that stand there"


def open_end(function: Callable[..., Any], above: tuple[Any, ...] = ()) -> str:
    """What in a function, or in one that it calls, may never end, with its line; else empty.

    above  the functions that call it
    """
    if not isinstance(function, FunctionType):
        return f"'{getattr(function, '__name__', function)}' is no function whose text can be read"
    lines, first = inspect.getsourcelines(function)
    tree = ast.parse(textwrap.dedent("".join(lines))).body[0]
    ast.increment_lineno(tree, first - 1)
    return next(_faults(tree, function, (*above, function)), "")


def _faults(tree: ast.stmt, function: FunctionType, above: tuple[Any, ...]) -> Iterator[str]:
    if not isinstance(tree, ast.FunctionDef):
        yield f"line {tree.lineno}: a kernel is written by `def`"
        return
    for loop, turns in _loops(tree.body, 1):
        if turns > MOST:
            yield f"line {loop.lineno}: `{_shown(loop)}` {_why(turns)}; {SAID}"
    marks = [mark for mark in tree.decorator_list if ast.unparse(mark) != "staticmethod"]
    nodes = [n for part in (tree.args, *tree.body) for n in ast.walk(part)]
    given = [a for n in nodes if isinstance(n, ast.Call) for a in n.args]
    for node in [*marks, *nodes]:
        line = f"line {getattr(node, 'lineno', tree.lineno)}: "
        grows = isinstance(node, ast.List) and node not in given
        if node in marks or grows or not isinstance(node, PARTS):
            ends = " may never end" if isinstance(node, ast.While) else ""
            yield f"{line}`{_shown(node)}`{ends}; {SAID}"
        elif isinstance(node, ast.Call) and (wrong := _call(node, function, above)):
            yield line + wrong


def _why(turns: float) -> str:
    return "may never end" if math.isinf(turns) else f"has {turns:.0f} turns, {MOST} at most"


def _shown(node: ast.AST) -> str:
    return ast.unparse(node).strip().splitlines()[0][:60].rstrip(":")


def _loops(body: list[ast.stmt], around: float) -> Iterator[tuple[ast.For, float]]:
    """Loops, each with its turns times those of the loops around it."""
    for node in body:
        turns = around * _turns(node.iter) if isinstance(node, ast.For) else around
        if isinstance(node, ast.For):
            yield node, turns
        if isinstance(node, ast.For | ast.If):
            yield from _loops([*node.body, *node.orelse], turns)


def _turns(over: ast.expr) -> float:
    """Turns of a loop over this; without bound where they do not stand there."""
    if isinstance(over, ast.Tuple):
        return len(over.elts)
    try:
        called = ast.unparse(over).startswith("range(") and isinstance(over, ast.Call)
        numbers = [ast.literal_eval(n) for n in over.args] if isinstance(over, ast.Call) else []
        return len(range(*numbers)) if called else math.inf
    except (ValueError, TypeError, OverflowError):
        return math.inf


def _call(node: ast.Call, function: FunctionType, above: tuple[Any, ...]) -> str:
    """What is wrong with a call: it is of something that may never end."""
    called, known = node.func, function.__globals__
    if isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name):
        module = known.get(called.value.id)
        if (module is math and called.attr not in WHOLE) or (
            module is np and _of_a_number(called.attr)
        ):
            return ""
    elif isinstance(called, ast.Name):
        found = known.get(called.id, getattr(builtins, called.id, None))
        if found in above:
            return f"`{called.id}` calls itself; {SAID}"
        if isinstance(found, FunctionType):
            return open_end(found, above)
        if found is getattr(builtins, called.id, known) and (
            called.id in PLAIN or (isinstance(found, type) and issubclass(found, Exception))
        ):
            return ""
        if getattr(found, "__module__", "") == "math" and called.id not in WHOLE:
            return ""
    return f"`{_shown(called)}` is nothing that a kernel can call"


def _of_a_number(name: str) -> bool:
    return name in TABLES or isinstance(getattr(np, name, None), np.ufunc)
