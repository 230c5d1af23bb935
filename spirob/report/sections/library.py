"""Every effect that the diagnosis knows, so that a reader can judge what it might have said.

Equations of effects are MathML, which browsers set themselves.  An equation is text in Python's
syntax: numbers by symbol (`T_c`), signals by name (`rest_speed`).  It is parsed, never evaluated.
"""

import ast
import unicodedata
from collections.abc import Callable, Collection
from itertools import groupby
from typing import Any

from markupsafe import Markup, escape

from spirob.effects import all_effects
from spirob.effects.effect import Effect
from spirob.ports import PORTS, SIGNALS
from spirob.report.data import ReportData
from spirob.report.sections import Section
from spirob.report.words import given, unit_text

SUM, PRODUCT, SIGNED, POWER, ATOM = range(5)  # how tightly a part is bound
Part = tuple[str, int]
LINES = {ast.Add: "+", ast.Sub: "−"}


def equation(left: str, text: str, symbols: Collection[str]) -> Markup:
    """`left` = text, displayed; `left` is markup already, such as `word("torque")`.

    Raises SyntaxError where `text` is no expression of sums, products, powers and functions.
    """
    right = expression(text, symbols)
    return Markup(f'<math display="block"><mrow>{left}<mo>=</mo>{right}</mrow></math>')


def expression(text: str, symbols: Collection[str]) -> str:
    """The parts of one expression."""
    known = {unicodedata.normalize("NFKC", symbol) for symbol in symbols}
    return _set(ast.parse(text.strip(), mode="eval").body, known)[0]


def word(text: str) -> str:
    """A signal or state by its name."""
    return f"<mtext>{escape(text.replace('_', ' '))}</mtext>"


def symbol(text: str) -> str:
    """A symbol such as T_c with its index."""
    name, _, index = text.partition("_")
    if not index:
        return f"<mi>{escape(name)}</mi>"
    kind = "mn" if index.isdigit() else "mi"
    return f"<msub><mi>{escape(name)}</mi><{kind}>{escape(index)}</{kind}></msub>"


def rate(state: str) -> str:
    """d state / dt."""
    return f"<mfrac><mrow><mi>d</mi>{word(state)}</mrow><mrow><mi>d</mi><mi>t</mi></mrow></mfrac>"


def _set(node: ast.expr, symbols: Collection[str]) -> Part:
    def inner(child: ast.expr) -> Part:
        return _set(child, symbols)

    match node:
        case ast.Name(id=name):
            return (symbol(name) if name in symbols else word(name)), ATOM
        case ast.Constant(value=int() | float() as value):
            return f"<mn>{value:g}</mn>", ATOM
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return f"<mo>−</mo>{_held(inner(operand), PRODUCT)}", SIGNED
        case ast.BinOp():
            return _binary(node, inner)
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return _call(name, [inner(argument) for argument in arguments])
    raise SyntaxError(f"'{ast.unparse(node)}' cannot be set as a formula")


def _binary(node: ast.BinOp, inner: Callable[[ast.expr], Part]) -> Part:
    left, right = inner(node.left), inner(node.right)
    kind = type(node.op)
    if kind in LINES:
        return f"{left[0]}<mo>{LINES[kind]}</mo>{_held(right, PRODUCT)}", SUM
    if kind is ast.Mult:
        first = left[0] if left[1] == SIGNED else _held(left, PRODUCT)
        return f"{first}<mo>⋅</mo>{_held(right, PRODUCT)}", PRODUCT
    if kind is ast.Div:
        return f"<mfrac><mrow>{left[0]}</mrow><mrow>{right[0]}</mrow></mfrac>", POWER
    if kind is ast.Pow:
        return f"<msup><mrow>{_held(left, ATOM)}</mrow><mrow>{right[0]}</mrow></msup>", POWER
    raise SyntaxError(f"'{ast.unparse(node)}' cannot be set as a formula")


def _call(name: str, arguments: list[Part]) -> Part:
    listed = "<mo>,</mo>".join(text for text, _ in arguments)
    if name == "Abs":
        return f"<mrow><mo>|</mo>{listed}<mo>|</mo></mrow>", ATOM
    if name == "sqrt":
        return f"<msqrt>{listed}</msqrt>", ATOM
    if name == "exp":
        return f"<msup><mi>e</mi><mrow>{listed}</mrow></msup>", POWER
    shown = {"Max": "max", "Min": "min", "sign": "sgn"}.get(name, name)
    return f"<mrow><mi>{escape(shown)}</mi>{_fenced(listed)}</mrow>", ATOM


def _held(part: Part, least: int) -> str:
    """A part in brackets where it is bound more loosely than its place asks for."""
    text, bound = part
    return text if bound >= least and bound != SIGNED else _fenced(text)


def _fenced(text: str) -> str:
    return f"<mrow><mo>(</mo>{text}<mo>)</mo></mrow>"


def card(effect: type[Effect]) -> dict[str, Any]:
    """Everything that the template prints of one effect."""
    port = PORTS[effect.port]
    return {
        "name": effect.name(),
        "title": effect.title,
        "place": effect.__module__.split(".")[-2],
        "port": effect.port,
        "does": f"{'is a part of' if port.combine == 'sum' else 'changes'} the {port.meaning}",
        "explanation": effect.explanation,
        "signature": effect.signature,
        "equations": equations(effect),
        "reads": [SIGNALS[signal].meaning for signal in effect.reads.values()],
        "numbers": [
            {
                "name": name,
                "symbol": Markup(f"<math>{symbol(about.symbol)}</math>"),
                "meaning": about.meaning,
                "nominal": given(about.nominal),
                "bounds": f"{given(about.low)} to {given(about.high)}",
                "unit": unit_text(about.unit),
                "absent_at": given(effect.neutral[name]) if name in effect.neutral else "",
            }
            for name, about in effect.parameters().items()
        ],
        "needs": effect.needs,
        "tell_apart": {rival.replace("_", " "): test for rival, test in effect.tell_apart.items()},
        "references": effect.references,
    }


def equations(effect: type[Effect]) -> list[Markup]:
    """The law and, where it has a memory, how that changes; empty where it is no formula."""
    symbols = [about.symbol for about in effect.parameters().values()]
    found = []
    if effect.equation:
        left = word(effect.port.rpartition(".")[2])
        found.append(equation(left, effect.equation, symbols))
    for state, law in effect.evolution.items():
        found.append(equation(rate(state), law, symbols))
    return found


PLACES = ("motor", "winch", "tendon", "body", "sensing")  # along the machine; others follow


class Library(Section):
    """All effects by place, each with its law, its numbers and what tells it from others."""

    order = 80
    title = "Library"
    template = "library.html.j2"
    pages = ("arm", "rig")

    def get_context(self, data: ReportData) -> dict[str, Any]:
        cards = sorted((card(effect) for effect in all_effects().values()), key=_along)
        places = [(place, list(group)) for place, group in groupby(cards, lambda c: c["place"])]
        return {
            "count": len(cards),
            "places": places,
            "named": {effect["name"] for effect in data.diagnosis["effects"]},
        }


def _along(about: dict[str, Any]) -> tuple[int, str, str]:
    place = about["place"]
    return PLACES.index(place) if place in PLACES else len(PLACES), place, about["name"]
