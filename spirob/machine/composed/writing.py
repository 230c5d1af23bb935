"""A composed law as an ordinary effect file, which everything that takes effects takes.

What stands in the file are texts of the grammar and floats as Python writes them; no name of a log,
a column or a rig ever becomes a part of it.
"""

import re
import textwrap
from collections.abc import Mapping

from spirob.effects import Effect
from spirob.identify.intervals import Estimate
from spirob.machine.composed.law import Law, LawNumber, inlined
from spirob.machine.composed.memory import MEMORIES
from spirob.machine.composed.track import SHORT

IN_PYTHON = {
    "Abs": "abs",
    "Max": "max",
    "Min": "min",
    "exp": "math.exp",
    "cos": "math.cos",
    "sin": "math.sin",
    "tanh": "math.tanh",
    "pi": "math.pi",
}
WIDE = 96  # characters of a line
FILE = '''"""{title}.

A law that was composed from logs: what a model left of them, by the motion.  It knows the motion
that taught it (`taught`), and nothing beyond.  For an axis that slides read N for N·m and m for
rad; for one whose effort is a current or a voltage, its unit for N·m; m is the axis' own unit.
"""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class Law(Effect):
    """τ = -Σ A·φ: see `equation`."""

    port = "motor.torque"
    reads = {reads}
{state}    neutral = {neutral}
    held = {held}
    taught = {taught}
{traits}    equation = {equation}
{evolution}    title = {quoted}
    signature = {signature}
    explanation = "Composed from what was left of logs; a cause is not known."
    tell_apart = {{{rival!r}: "fit both on further logs: the law keeps its numbers if it is right"}}
    needs = "motion within the range that taught it"
    references = ("composed from measured logs",)

{numbers}

    @staticmethod
    def kernel({arguments}):
        """Torque on the rotor [N·m]{more}."""
{lines}
'''


def written(
    law: Law, title: str, rival: type[Effect], estimates: Mapping[str, Estimate] | None = None
) -> str:
    """The text of the file.

    title      what shape the law has;  rival  the effect of the library that it resembles most
    estimates  by field, where the numbers are fitted
    """
    fields, reads = [n.field for n in law.numbers], law.reads()
    amplitudes = {f"amplitude_{k}": 0.0 for k in range(1, law.terms + 1)}
    held = [n.field for n in law.numbers if n.field in vars(law.ranges)]
    taught = {a: ends for a, ends in law.ranges.taught().items() if a in reads}
    state, evolution, arguments = "", "", [*reads]
    if law.memory is not None:
        memory = MEMORIES[law.memory[1].memory]
        state = f"    state = {{{memory.name!r}: 0.0}}\n"
        rate = memory.evolution.format(**_filled(law, "symbol"))
        evolution = f"    evolution = {{{memory.name!r}: {_wrapped(rate, 8)}}}\n"
        arguments.append(memory.name)
    arguments += [*fields, *(["dt"] if state else [])]
    traits = '    traits = {"dissipative"}\n' if law.brakes else ""
    first = title[:1].upper() + title[1:]
    return FILE.format(
        title=textwrap.fill(first, WIDE),
        reads=_dict(reads),
        state=state,
        neutral=_dict(amplitudes),
        held="{" + ", ".join(map(repr, held)) + "}" if held else "frozenset()",
        taught=_dict(taught),
        traits=traits,
        equation=_wrapped(law.equation, 8),
        evolution=evolution,
        quoted=_wrapped(title, 8),
        signature=_wrapped(f"{first}.", 8),
        rival=rival.name(),
        numbers="\n".join(_declared(n, (estimates or {}).get(n.field)) for n in law.numbers),
        arguments=", ".join(arguments),
        more=" and the next memory" if state else "",
        lines="\n".join(f"        {line}" for line in _lines(law)),
    )


def _lines(law: Law) -> list[str]:
    """The body of the kernel."""
    texts = [law.named(k) for k in range(law.terms)]
    body, name = [], ""
    if law.memory is not None:
        shape = law.memory[1]
        memory, name = MEMORIES[shape.memory], MEMORIES[shape.memory].name
        body = [line.format(**_filled(law, "field")) for line in memory.lines]
        texts.append(shape.followed)
    words = set(re.findall(r"[A-Za-z_]\w*", " ".join(texts)))
    short = [f"{n} = {text}" for n, text in SHORT.items() if n in words]
    parts = [f"torque -= amplitude_{k + 1} * ({law.named(k)})" for k in range(law.terms)]
    end = f"return torque, {name}" if name else "return torque"
    return [_python(line) for line in (*short, *body, "torque = 0.0", *parts, end)]


def _filled(law: Law, which: str) -> dict[str, str]:
    """What stands for the number of a memory, and for what it follows: fields or symbols."""
    assert law.memory is not None
    k, shape = law.memory
    key = "e" if shape.memory == "slow" else "r"
    field = law.named(k, key)
    if which == "field":
        return {"reach": field, "followed": shape.followed}
    symbols = {n.field: n.symbol for n in law.numbers}
    followed = inlined(shape.followed)
    for name, symbol in symbols.items():
        followed = re.sub(rf"\b{name}\b", symbol, followed)
    return {"reach": symbols[field], "followed": followed}


def _python(text: str) -> str:
    return re.sub(r"[A-Za-z_]\w*", lambda m: IN_PYTHON.get(m.group(), m.group()), text)


def _declared(number: LawNumber, found: Estimate | None) -> str:
    about = (
        f"    {number.field}: float = bounded({number.value!r}, {number.low!r}, {number.high!r}, "
        f"{number.unit!r}, {number.symbol!r}, {number.meaning!r}"
        + (", log=True)" if number.log and number.low > 0.0 else ")")
    )
    return about if found is None else f"{about}  # 95 %: {found.low:.4g} to {found.high:.4g}"


def _dict(entries: Mapping[str, object]) -> str:
    inside = ", ".join(f"{key!r}: {value!r}" for key, value in entries.items())
    return "{" + inside + "}"


def _wrapped(text: str, indent: int) -> str:
    """A string literal, over several lines where it is long."""
    if len(text) <= 70:
        return repr(text)
    lines = textwrap.wrap(text, 80, drop_whitespace=False, break_on_hyphens=False)
    space = "\n" + " " * indent
    return f"({space}{space.join(map(repr, lines))}\n    )"
