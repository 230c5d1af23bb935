"""Plain arithmetic in Python, checked against a list of what may stand in it, and as C99.

What a kernel may hold: arithmetic, comparisons, `math`, `abs`, `min`, `max`, `int`, `float`, `if`,
a loop over `range` of a number, a tuple of values with an index into it, and functions of its own
file.  Everything else is refused in a sentence, so no text of a file becomes code unchecked.
"""

import ast
import math
from collections.abc import Mapping

from spirob.errors import ExportError

MATH = {
    "acos": 1, "asin": 1, "atan": 1, "atan2": 2, "ceil": 1, "copysign": 2, "cos": 1, "cosh": 1,
    "exp": 1, "expm1": 1, "fabs": 1, "floor": 1, "hypot": 2, "log": 1, "log1p": 1, "pow": 2,
    "sin": 1, "sinh": 1, "sqrt": 1, "tan": 1, "tanh": 1, "trunc": 1,
}  # fmt: skip
NUMBERS = {"pi": "3.141592653589793", "e": "2.718281828459045", "tau": "6.283185307179586"}
BUILTIN = {"abs": (1, 1), "float": (1, 1), "int": (1, 1), "min": (2, 9), "max": (2, 9)}
SIGNS = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/",
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
    ast.And: "&&", ast.Or: "||", ast.Not: "!", ast.USub: "-", ast.UAdd: "+",
}  # fmt: skip
CALLED = {ast.Pow: "pow", ast.Mod: "modulo", ast.FloorDiv: "whole"}
MOST = 1000  # turns of a loop
RESERVED = frozenset(  # names that mean something else in C
    [
        "auto",
        "break",
        "case",
        "char",
        "const",
        "continue",
        "default",
        "do",
        "double",
        "else",
        "enum",
        "extern",
        "float",
        "for",
        "goto",
        "if",
        "inline",
        "int",
        "long",
        "register",
        "restrict",
        "return",
        "short",
        "signed",
        "sizeof",
        "static",
        "struct",
        "switch",
        "typedef",
        "union",
        "unsigned",
        "void",
        "volatile",
        "while",
        "main",
        "M_PI",
        "smaller",
        "larger",
        "whole",
        "modulo",
        "place",
    ]
)
HELP = """\
static inline double smaller(double a, double b) { return b < a ? b : a; }
static inline double larger(double a, double b) { return b > a ? b : a; }
static inline double whole(double a, double b) { return floor(a / b); }
static inline double modulo(double a, double b) { return a - b * floor(a / b); }
static inline int place(double x, int n)
{
    return x > 0.0 ? (x < n - 1 ? (int)x : n - 1) : 0;
}
"""


class Function:
    """One function of plain arithmetic, checked; `c` is its text in C99.

    known     functions that it may call -> how many values they return
    given     names of constants that exist
    state     the argument that holds the memory, whose fields it may read and set; "" for none
    """

    def __init__(
        self,
        who: str,
        node: ast.FunctionDef,
        known: Mapping[str, int],
        given: frozenset[str] = frozenset(),
        state: str = "",
    ):
        self.who, self.node, self.known, self.given, self.state = who, node, known, given, state
        a = node.args
        if a.posonlyargs or a.kwonlyargs or a.vararg or a.kwarg or a.defaults:
            raise self._refused("arguments that are not plain names")
        self.arguments = [x.arg for x in a.args]
        if taken := [name for name in self.arguments if name in BUILTIN or name == "math"]:
            raise self._refused(f"an argument called '{taken[0]}'")
        self.locals: dict[str, int] = {}  # name -> length of the tuple in it, 0 for a number
        self.read: set[str] = set()
        self.values = self._returned()
        body = [s for s in node.body if not _is_text(s)]
        self._lines = self._block(body, 1)

    @property
    def c(self) -> str:
        """The function in C."""
        arguments = [f"double {_safe(a)}" for a in self.arguments if a != self.state]
        arguments += [f"double *next_{k}" for k in range(1, self.values)]
        if self.state:
            arguments.insert(0, f"STATE *{self.state}")
        own = [
            f"    double {_safe(n)}[{k}];" if k else f"    double {_safe(n)} = 0.0;"
            for n, k in self.locals.items()
        ]
        unread = [n for n in (*self.arguments, *self.locals) if n not in self.read]
        silent = [f"    (void){_safe(n)};" for n in unread]
        head = f"static inline double {self.node.name}({', '.join(arguments) or 'void'})"
        return "\n".join([head, "{", *own, *silent, *self._lines, "}"])

    def _refused(self, what: str, node: ast.AST | None = None) -> ExportError:
        line = f" (line {node.lineno})" if isinstance(node, ast.stmt | ast.expr) else ""
        return ExportError(f"{self.who}: its kernel holds {what}{line}, which cannot leave")

    def _returned(self) -> int:
        counts = {
            len(n.value.elts) if isinstance(n.value, ast.Tuple) else 1
            for n in ast.walk(self.node)
            if isinstance(n, ast.Return)
        }
        if len(counts) != 1:
            raise self._refused("returns of different lengths")
        return counts.pop()

    def _block(self, body: list[ast.stmt], depth: int) -> list[str]:
        return [line for statement in body for line in self._statement(statement, depth)]

    def _statement(self, node: ast.stmt, depth: int) -> list[str]:
        pad = "    " * depth
        if isinstance(node, ast.Assign) and len(node.targets) == 1:
            return [pad + line for line in self._assign(node.targets[0], node.value)]
        if isinstance(node, ast.AugAssign):
            value = ast.BinOp(node.target, node.op, node.value)  # type: ignore[arg-type]
            return [
                pad + line for line in self._assign(node.target, ast.copy_location(value, node))
            ]
        if isinstance(node, ast.If):
            lines = [f"{pad}if ({self._value(node.test)}) {{", *self._block(node.body, depth + 1)]
            if node.orelse:
                lines += [f"{pad}}} else {{", *self._block(node.orelse, depth + 1)]
            return [*lines, pad + "}"]
        if isinstance(node, ast.For) and not node.orelse:
            return self._loop(node, depth)
        if isinstance(node, ast.Break):
            return [pad + "break;"]
        if isinstance(node, ast.Return) and node.value:
            return [pad + line for line in self._return(node.value)]
        if isinstance(node, ast.Pass):
            return []
        raise self._refused(f"a statement '{type(node).__name__.lower()}'", node)

    def _loop(self, node: ast.For, depth: int) -> list[str]:
        call, pad = node.iter, "    " * depth
        plain = isinstance(call, ast.Call) and isinstance(call.func, ast.Name)
        if not (plain and call.func.id == "range" and len(call.args) == 1):  # type: ignore
            raise self._refused("a loop over something else than a range", node)
        count = call.args[0]  # type: ignore[attr-defined]
        if not (isinstance(count, ast.Constant) and type(count.value) is int):
            raise self._refused("a loop whose length is not written there", node)
        if count.value > MOST or not isinstance(node.target, ast.Name):
            raise self._refused(f"a loop of more than {MOST} turns", node)
        name = self._new(node.target, 0)
        head = f"{pad}for ({name} = 0.0; {name} < {count.value}.0; {name} += 1.0) {{"
        return [head, *self._block(node.body, depth + 1), pad + "}"]

    def _assign(self, target: ast.expr, value: ast.expr) -> list[str]:
        if isinstance(target, ast.Name):
            if isinstance(value, ast.Tuple):
                parts = [self._value(e) for e in value.elts]
                name = self._new(target, len(parts))
                return [f"{name}[{k}] = {part};" for k, part in enumerate(parts)]
            text = self._value(value)
            return [f"{self._new(target, 0)} = {text};"]
        if isinstance(target, ast.Attribute):
            text = self._value(value)
            return [f"{self._field(target)} = {text};"]
        if not isinstance(target, ast.Tuple):
            raise self._refused("an assignment to a part of something", target)
        if isinstance(value, ast.Tuple) and len(value.elts) == len(target.elts):
            parts = [self._value(e) for e in value.elts]
            kept = [f"const double kept_{k} = {p};" for k, p in enumerate(parts)]
            names = [self._target(t) for t in target.elts]
            return ["{", *kept, *(f"{n} = kept_{k};" for k, n in enumerate(names)), "}"]
        if isinstance(value, ast.Call):
            text = self._call(value, len(target.elts))
            first, *others = [self._target(t) for t in target.elts]
            return [f"{first} = {text[:-1]}, {', '.join('&' + o for o in others)});"]
        raise self._refused("an assignment of several values from one", target)

    def _target(self, node: ast.expr) -> str:
        if isinstance(node, ast.Name):
            return self._new(node, 0)
        if isinstance(node, ast.Attribute):
            return self._field(node)
        raise self._refused("an assignment to a part of something", node)

    def _new(self, node: ast.Name, length: int) -> str:
        if node.id in {*self.known, *self.given, *BUILTIN, "math", self.state}:
            raise self._refused(f"a new value for '{node.id}'", node)
        if node.id not in self.arguments and self.locals.setdefault(node.id, length) != length:
            raise self._refused(f"'{node.id}' once as a number and once as a tuple", node)
        return _safe(node.id)

    def _return(self, value: ast.expr) -> list[str]:
        if not isinstance(value, ast.Tuple):
            return [f"return {self._value(value)};"]
        parts = [self._value(e) for e in value.elts]
        kept = [f"const double kept_{k} = {p};" for k, p in enumerate(parts)]
        stored = [f"*next_{k} = kept_{k};" for k in range(1, len(parts))]
        return ["{", *kept, *stored, "return kept_0;", "}"]

    def _value(self, node: ast.expr) -> str:
        if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            return self._number(node, float(node.value))
        if isinstance(node, ast.Name):
            return self._read(node)
        if isinstance(node, ast.Attribute):
            return self._attribute(node)
        if isinstance(node, ast.BinOp):
            return self._binary(node)
        if isinstance(node, ast.UnaryOp) and type(node.op) in SIGNS:
            return f"({SIGNS[type(node.op)]}{self._value(node.operand)})"
        if isinstance(node, ast.BoolOp):
            sign = f" {SIGNS[type(node.op)]} "
            return f"({sign.join(self._value(v) for v in node.values)})"
        if isinstance(node, ast.Compare):
            return self._compared(node)
        if isinstance(node, ast.IfExp):
            parts = [self._value(x) for x in (node.test, node.body, node.orelse)]
            return f"({parts[0]} ? {parts[1]} : {parts[2]})"
        if isinstance(node, ast.Subscript):
            return self._indexed(node)
        if isinstance(node, ast.Call):
            return self._call(node, 1)
        raise self._refused(f"'{ast.unparse(node)[:40]}'", node)

    def _number(self, node: ast.expr, value: float) -> str:
        if not math.isfinite(value):
            raise self._refused("a number that is not finite", node)
        return repr(value)

    def _read(self, node: ast.Name) -> str:
        self.read.add(node.id)
        if node.id in self.given or node.id in self.arguments:
            return _safe(node.id)
        if self.locals.get(node.id, 1) == 0:
            return _safe(node.id)
        raise self._refused(f"the name '{node.id[:40]}'", node)

    def _attribute(self, node: ast.Attribute) -> str:
        if isinstance(node.value, ast.Name) and node.value.id == "math" and node.attr in NUMBERS:
            return NUMBERS[node.attr]
        return self._field(node)

    def _field(self, node: ast.Attribute) -> str:
        if self.state and isinstance(node.value, ast.Name) and node.value.id == self.state:
            self.read.add(self.state)
            return f"{self.state}->{node.attr}"
        raise self._refused(f"'{ast.unparse(node)[:40]}'", node)

    def _binary(self, node: ast.BinOp) -> str:
        left, right = self._value(node.left), self._value(node.right)
        if type(node.op) in CALLED:
            return f"{CALLED[type(node.op)]}({left}, {right})"
        if type(node.op) not in SIGNS:
            raise self._refused(f"'{ast.unparse(node)[:40]}'", node)
        return f"({left} {SIGNS[type(node.op)]} {right})"

    def _compared(self, node: ast.Compare) -> str:
        sides = [self._value(x) for x in (node.left, *node.comparators)]
        if any(type(op) not in SIGNS for op in node.ops):
            raise self._refused(f"'{ast.unparse(node)[:40]}'", node)
        pairs = [f"{sides[k]} {SIGNS[type(op)]} {sides[k + 1]}" for k, op in enumerate(node.ops)]
        return f"({' && '.join(pairs)})"

    def _indexed(self, node: ast.Subscript) -> str:
        name = node.value.id if isinstance(node.value, ast.Name) else ""
        if not (length := self.locals.get(name, 0)):
            raise self._refused(f"'{ast.unparse(node)[:40]}'", node)
        self.read.add(name)
        return f"{_safe(name)}[place({self._value(node.slice)}, {length})]"

    def _call(self, node: ast.Call, values: int) -> str:
        if node.keywords or any(isinstance(a, ast.Starred) for a in node.args):
            raise self._refused("a call with arguments by name", node)
        name = ast.unparse(node.func)
        own = name in self.known
        if own and _is_state(node.args, self.state):
            self.read.add(self.state)
        passed = node.args[1:] if own and _is_state(node.args, self.state) else node.args
        given = [self._value(a) for a in passed]
        if own and self.known[name] == values:
            return (
                f"{name}({', '.join([self.state, *given] if passed is not node.args else given)})"
            )
        base, _, function = name.rpartition(".")
        if base == "math" and MATH.get(function) == len(given) and values == 1:
            return f"{function}({', '.join(given)})"
        low, high = BUILTIN.get(name, (1, 0))
        if low <= len(given) <= high and values == 1:
            return _builtin(name, given)
        raise self._refused(f"a call of '{name[:40]}'", node)


def _builtin(name: str, given: list[str]) -> str:
    if name == "float":
        return given[0]
    if name in ("abs", "int"):
        return f"{'fabs' if name == 'abs' else 'trunc'}({given[0]})"
    out = given[0]
    for other in given[1:]:
        out = f"{'smaller' if name == 'min' else 'larger'}({out}, {other})"
    return out


def _is_state(arguments: list[ast.expr], state: str) -> bool:
    first = arguments[0] if arguments else None
    return bool(state) and isinstance(first, ast.Name) and first.id == state


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _safe(name: str) -> str:
    """A name as it may stand in C."""
    plain = name if name.isascii() else "_".join(f"{ord(c):x}" for c in name)
    return f"{plain}_" if plain in RESERVED | MATH.keys() or not name.isascii() else plain
