"""A composed law as an ordinary effect file, and in words.

Everything that takes effects takes such a file.  What stands in it are texts of the grammar and
floats as Python writes them; no name of a log, a column or a rig ever becomes a part of it.
"""

import re
import textwrap
from collections.abc import Mapping
from typing import Protocol

from spirob.effects import Effect
from spirob.identify.intervals import Estimate
from spirob.machine.composed.law import Law, LawNumber, Part, inlined
from spirob.machine.composed.track import MEMORIES, SHORT


class Units(Protocol):
    """What the quantities of a machine are given in."""

    @property
    def torque_unit(self) -> str:
        """Of the law itself."""

    def unit(self, unit: str) -> str:
        """For what is `unit` of a rotor whose place is in m."""


PHRASES = {  # kind of a shape -> what is said of it
    "way": "against the motion",
    "line": "in proportion to speed",
    "share": "in proportion to speed, the same way in both directions",
    "drag": "that grows with the square of speed",
    "lift": "with the square of speed, the same way in both directions",
    "power": "that grows with the power {p} of speed",
    "fading": "that fades beyond {f} in speed",
    "forward fading": "that fades beyond {f} in speed, forward alone",
    "backward fading": "that fades beyond {f} in speed, backward alone",
    "settling": "that levels off beyond {s} in speed",
    "even power": "with the power {p} of speed, the same way in both directions",
    "even fading": "that fades beyond {f} in speed, the same way in both directions",
    "even settling": "that levels off beyond {s} in speed, the same way in both directions",
    "steady": "the same everywhere",
    "far": "in proportion to the place",
    "far2": "with the square of the place",
    "far3": "with the cube of the place",
    "cubic": "of a spring of third order over the way",
    "cubic about any place": "of a spring of third order about any place",
    "spot": "in a spot at {c}, half width {w}",
    "turning spot": "in a spot of the turn at {c}, half width {w}",
    "wave": "in waves that come round every {L}",
    "chirp": "in waves that come round every {L} at {c}, at another pitch away from there",
    "late": "that changes with time",
    "late2": "with the square of time",
    "tide": "that comes and goes every {T}",
    "swell": "of a level that comes and goes every {T}",
    "decay": "that decays in {d}",
    "weight": "in proportion to the load's size",
    "pull": "in proportion to the load",
    "given": "in proportion to load and viscous friction",
    "hard": "with the cube of load and viscous friction",
    "levelling": "of load and viscous friction, levelling off beyond {u} of the largest load",
    "passed": "in proportion to load and viscous friction",
    "bristle": "that turns round over {r}",
    "spring": "of a spring that yields over {r}",
    "slow direction": "that follows the direction in {e}",
    "slow speed": "that follows the speed in {e}",
    "slow load": "that follows the load in {e}",
    "slow heat": "that follows the square of load and viscous friction in {e}",
    "slow place": "that follows the place in {e}",
    "ringing": "that rings every {T} after the motion turns, and fades in {d}",
    "working": "less where it makes the motion and more where it is moved",
    "driving": "where it makes the motion",
    "driven": "where it is moved",
    "effort power": "with the power {n} of the effort",
    "effort settling": "with the power {n} of the effort, levelling off beyond {h} of the largest",
    "dead band": "of a dead band up to {z} of the largest effort",
    "slow warmth": "that follows the square of the effort in {e}, levelling off beyond {h}",
}
CURVE = "in a curve over the way"

FORMULAS = {  # of place x, speed v, load T, time t, v_0 of rest; D = T/T_max + m·v/v_max
    "way": "tanh(v/v_0)",
    "line": "v/v_max",
    "share": "|v|/v_max",
    "drag": "sign(v)·(v/v_max)²",
    "lift": "(v/v_max)²",
    "power": "sign(v)·|v/v_max|^{p}",
    "fading": "sign(v)·exp(-(v/{f})²)",
    "forward fading": "max(0, sign(v))·exp(-(v/{f})²)",
    "backward fading": "min(0, sign(v))·exp(-(v/{f})²)",
    "settling": "v/(|v| + {s})",
    "even power": "|v/v_max|^{p}",
    "even fading": "exp(-(v/{f})²)",
    "even settling": "|v|/(|v| + {s})",
    "steady": "",
    "far": "ξ",
    "far2": "ξ²",
    "far3": "ξ³",
    "cubic": "(ξ, ξ², ξ³)",
    "cubic about any place": "(1, ξ, ξ², ξ³)",
    "spot": "exp(-½((x - {c})/{w})²)",
    "turning spot": "exp(-½(2·sin((x - {c})/2)/{w})²)",
    "wave": "cos(2π·x/{L} - {a})",
    "chirp": "cos(2π·(x - {c})·(1 + {g}·|x - {c}|/x_max)/{L} - {a})",
    "late": "t/t_max",
    "late2": "(t/t_max)²",
    "tide": "cos(2π·t/{T} - {b})",
    "swell": "(1, cos(2π·t/{T}), sin(2π·t/{T}))",
    "decay": "exp(-t/{d})",
    "weight": "|T|/T_max",
    "pull": "T/T_max",
    "given": "D",
    "hard": "D³",
    "levelling": "D/(|D| + {u})",
    "passed": "|D|",
    "bristle": "z",
    "spring": "z",
    "slow direction": "low-pass(sign(v), {e} s)",
    "slow speed": "low-pass(|v|/v_max, {e} s)",
    "slow load": "low-pass(T/T_max, {e} s)",
    "slow heat": "low-pass(D², {e} s)",
    "slow place": "low-pass(ξ, {e} s)",
    "ringing": "sign(v)·exp(-t_r/{d})·cos(2π·t_r/{T} - {b})",
    "working": "sign(i·v)",
    "driving": "max(0, sign(i·v))",
    "driven": "max(0, -sign(i·v))",
    "effort power": "|i/i_max|^{n}",
    "effort settling": "|i|^{n}/(|i|^{n} + ({h}·i_max)^{n})",
    "dead band": "min(1, {z}·i_max/|i|)",
    "slow warmth": "W/(W + {h}), W = low-pass((i/i_max)², {e} s)",
}


def told(law: Law, sizes: Units) -> str:
    """The shape of the whole law, without a full stop."""
    noun = "friction" if law.brakes else "effort"
    noun = "loss of the drive's torque" if law.of_drive else noun
    return f"{noun} " + ", and ".join(_phrase(part, sizes) for part in law.parts)


def _phrase(part: Part, sizes: Units) -> str:
    shown = {key: _shown(key, value, sizes) for key, value in part.numbers.items()}
    phrases = [PHRASES.get(kind, CURVE) for kind in part.term.kinds]
    if part.term.memory is not None and part.term.memory.kind not in MEMORIES:
        phrases += [PHRASES["bristle"]] if part.term.memory.memory == "bristle" else []
    return " ".join(phrase.format(**shown) for phrase in phrases)


def _shown(key: str, value: float, sizes: Units) -> str:
    if key in ("p", "m", "u", "n", "h", "z"):
        return f"{value:.2g}"
    units = {"c": "m", "w": "m", "L": "m", "f": "rad/s", "s": "rad/s", "r": "rad"}
    unit = sizes.unit(units[key]) if key in units else "s"
    return f"{value:.3g} {unit}"


def formula(law: Law, sizes: Units) -> str:
    """The law as a reader writes it, with its numbers."""
    terms = []
    for part in law.parts:
        shown = {key: f"{value:.3g}" for key, value in part.numbers.items()}
        shapes = [FORMULAS.get(kind, "curve(x)").format(**shown) for kind in part.term.kinds]
        product = "·".join(shape for shape in shapes if shape)
        size = f"{part.amplitude:.3g}" + ("" if law.of_drive else f" {sizes.torque_unit}")
        terms.append(f"{size}·{product}" if product else size)
    shares = {f"{part.numbers['m']:.3g}" for part in law.parts if "m" in part.numbers}
    where = [f"D = T/T_max + {share}·v/v_max" for share in sorted(shares)]
    whole = f"({' + '.join(terms)})"
    whole = f"τ = τ_drive·(1 - {whole})" if law.of_drive else f"τ = -{whole}"
    return whole + "".join(f", {one}" for one in where)


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
    """{short}: see `equation`."""

    port = {port!r}
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
    upstream = ["upstream"] if law.of_drive else []
    amplitudes = {f"amplitude_{k}": 0.0 for k in range(1, law.terms + 1)}
    held = [n.field for n in law.numbers if n.field in vars(law.ranges)]
    taught = {a: ends for a, ends in law.ranges.taught().items() if a in reads}
    state, evolution, arguments = "", "", [*upstream, *reads]
    if law.memory is not None:
        memory = MEMORIES[law.memory[1].memory]
        state = f"    state = {_dict(memory.begin)}\n"
        rates = [rate.format(**_filled(law, "symbol")) for rate in memory.evolution]
        pairs = zip(memory.begin, rates, strict=False)
        whole = ", ".join(f"{name!r}: {_wrapped(rate, 8)}" for name, rate in pairs)
        evolution = f"    evolution = {{{whole}}}\n" if rates else ""
        arguments += memory.begin
    arguments += [*fields, *(["dt"] if state else [])]
    traits = '    traits = {"dissipative"}\n' if law.brakes else ""
    first = title[:1].upper() + title[1:]
    return FILE.format(
        title=textwrap.fill(first, WIDE),
        short="τ = τ_drive·(1 - Σ A·φ)" if law.of_drive else "τ = -Σ A·φ",
        port="motor.drive_torque" if law.of_drive else "motor.torque",
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
    body, names = [], ["torque"]
    if law.memory is not None:
        shape = law.memory[1]
        memory = MEMORIES[shape.memory]
        names += memory.begin
        body = [line.format(**_filled(law, "field")) for line in memory.lines]
        texts.append(shape.followed)
    words = set(re.findall(r"[A-Za-z_]\w*", " ".join(texts)))
    short = [f"{n} = {text}" for n, text in SHORT.items() if n in words]
    size = "upstream * amplitude" if law.of_drive else "amplitude"
    parts = [f"torque -= {size}_{k + 1} * ({law.named(k)})" for k in range(law.terms)]
    begin = f"torque = {'upstream' if law.of_drive else '0.0'}"
    end = f"return {', '.join(names)}"
    return [_python(line) for line in (*short, *body, begin, *parts, end)]


def _filled(law: Law, which: str) -> dict[str, str]:
    """What stands for the numbers of a memory, and for what it follows: fields or symbols."""
    assert law.memory is not None
    k, shape = law.memory
    fields = {name: law.named(k, key) for name, key in MEMORIES[shape.memory].numbers.items()}
    followed = law.named(k, shape.followed)
    if which == "field":
        return fields | {"followed": followed}
    symbols = {n.field: n.symbol for n in law.numbers}
    followed = inlined(followed)
    for name, symbol in symbols.items():
        followed = re.sub(rf"\b{name}\b", symbol, followed)
    return {name: symbols[field] for name, field in fields.items()} | {"followed": followed}


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
