"""A draft as a law of its own: every term with one amplitude, every number with a name.

    τ = -Σ A_k·φ_k,      or of a drive's torque    τ = τ_drive·(1 - Σ A_k·φ_k)

φ have no unit, A are torques: a positive amplitude of a term along the motion brakes.  Of a drive
A are the shares that it loses.  Outside of
the range of motion in which it was taught, a law says nothing.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from spirob.effects import Effect
from spirob.machine.composed.draft import Draft
from spirob.machine.composed.terms import DRIVE, NUMBERS, Shape, Term, closed
from spirob.machine.composed.track import MEMORIES, SHORT, SIGNALS, Ranges
from spirob.machine.inverse.problem import InverseProblem

MOST = 20.0  # times an amplitude, or the effort: how large a fit may make it
HEIGHT = 3.0  # of a curve's heights over its largest
HELD = {  # name in the texts -> symbol, unit, meaning
    "middle": ("x_m", "m", "middle of the way that taught the law"),
    "half": ("x_h", "m", "half of that way"),
    "fast": ("ω_f", "rad/s", "fastest speed that taught the law"),
    "heavy": ("T_l", "N·m", "largest load that taught the law"),
    "long": ("t_l", "s", "longest trial that taught the law"),
    "turn": ("x_t", "m", "a whole turn"),
    "strong": ("i_m", "A", "largest effort that taught the law"),
}
BRAKING = {"way", "line", "drag", "power", "fading", "settling", "bristle", "spring"}
BRAKING |= {"forward fading", "backward fading"}
WAVES = ("wave", "chirp", "tide", "ringing")
ALONE = (("bristle",), ("spring",))  # memories that take energy out of every closed motion
NEVER_BELOW = {"steady", "spot", "turning spot", "decay", "weight", "far2", "late", "late2"}


@dataclass(frozen=True)
class LawNumber:
    """A number of the law as its file declares it."""

    field: str
    symbol: str
    unit: str
    meaning: str
    value: float
    low: float
    high: float
    log: bool = False


@dataclass(frozen=True)
class Part:
    """A term with its amplitude.

    text      its shape, in the names of `track` and the symbols' keys
    numbers   of its shape, by key;  heights  of a curve, by place among its parts
    apart     the motors of the arm have it with opposite signs
    """

    term: Term
    amplitude: float
    text: str
    numbers: dict[str, float]
    heights: dict[int, float]
    apart: bool = False

    @property
    def brakes(self) -> bool:
        """Whether it takes energy out of the motion at every place, speed and time.

        A bristle gives back what it stored; times anything that changes meanwhile it may give more.
        """
        if self.term.memory is not None and self.term.kinds not in ALONE:
            return False
        kinds = [k for k in self.term.kinds if k not in BRAKING]
        one = len(kinds) == len(self.term.kinds) - 1
        brakes = self.amplitude > 0.0 and not self.apart
        return brakes and one and all(k in NEVER_BELOW for k in kinds)


@dataclass(frozen=True)
class Law:
    """The parts of a law, the ranges that taught it, and the effort's size [as torque].

    of_drive  whether it is what a drive loses of its torque; no size counts then
    """

    parts: tuple[Part, ...]
    ranges: Ranges
    size: float
    of_drive: bool = False

    @property
    def brakes(self) -> bool:
        """Whether it is a friction: no part of it ever drives the motion."""
        return not self.of_drive and all(part.brakes for part in self.parts)

    @property
    def memory(self) -> tuple[int, Shape] | None:
        """The place of the part that remembers, and its shape."""
        for k, part in enumerate(self.parts):
            if (shape := part.term.memory) is not None:
                return k, shape
        return None

    @property
    def terms(self) -> int:
        """How many."""
        return len(self.parts)

    @cached_property
    def numbers(self) -> list[LawNumber]:
        """All of them: amplitudes and shapes of each part, then those that are held."""
        return [*self._own(), *self._held()]

    @cached_property
    def equation(self) -> str:
        """The law in the symbols of its numbers and the names of its arguments."""
        symbols = {n.field: n.symbol for n in self.numbers}
        texts = [f"A_{k + 1}*{closed(self.named(k))}" for k in range(self.terms)]
        whole = f"-({' + '.join(texts)})"
        if self.of_drive:
            whole = f"upstream*(1 - ({' + '.join(texts)}))"
        return _renamed(inlined(whole), symbols)

    def named(self, k: int, text: str | None = None) -> str:
        """The text of a part, or another of it, with the fields of the law for its keys."""
        part = self.parts[k]
        fields = {key: f"{NUMBERS[key].field}_{k + 1}" for key in part.numbers}
        fields |= {f"h{j}": f"height_{k + 1}_{j + 1}" for j in part.heights}
        return _renamed(part.text if text is None else text, fields)

    def reads(self) -> dict[str, str]:
        """Argument -> signal, of those that its texts name."""
        texts = [inlined(part.text) for part in self.parts]
        if self.memory is not None:
            shape = self.memory[1]
            texts += [inlined(shape.followed), inlined(" ".join(MEMORIES[shape.memory].lines))]
        words = set(re.findall(r"[A-Za-z_]\w*", " ".join(texts)))
        signals = SIGNALS | {"place": self.ranges.position}
        return {name: signal for name, signal in signals.items() if name in words}

    def changes(self, owner: str) -> dict[str, float]:
        """Its numbers by full name."""
        return {f"{owner}.{n.field}": n.value for n in self.numbers}

    def at(self, values: Mapping[str, float]) -> "Law":
        """The same with other values of its numbers, by field."""
        parts = []
        for k, part in enumerate(self.parts, 1):
            numbers = {
                key: values.get(f"{NUMBERS[key].field}_{k}", old)
                for key, old in part.numbers.items()
            }
            heights = {j: values.get(f"height_{k}_{j + 1}", old) for j, old in part.heights.items()}
            amplitude = values.get(f"amplitude_{k}", part.amplitude)
            parts.append(replace(part, amplitude=amplitude, numbers=numbers, heights=heights))
        return replace(self, parts=tuple(parts))

    def only(self, places: Sequence[int]) -> "Law":
        """The law of these parts alone."""
        return replace(self, parts=tuple(self.parts[k] for k in places))

    def fields(self, k: int) -> list[str]:
        """The names of a part's numbers."""
        part, place = self.parts[k], k + 1
        shapes = [f"{NUMBERS[key].field}_{place}" for key in part.numbers]
        heights = [f"height_{place}_{j + 1}" for j in part.heights]
        return [f"amplitude_{place}", *shapes, *heights]

    def _own(self) -> Iterator[LawNumber]:
        for k, part in enumerate(self.parts, 1):
            most = MOST * max(abs(part.amplitude), 1.0 if self.of_drive else self.size)
            least = 0.0 if part.brakes and self.brakes else -most
            meaning = f"size of term {k}"
            unit, size = ("1" if self.of_drive else "N·m"), np.clip(part.amplitude, least, most)
            yield LawNumber(f"amplitude_{k}", f"A_{k}", unit, meaning, float(size), least, most)
            for key, value in part.numbers.items():
                about = NUMBERS[key]
                low, high = _PHASES if key in ("a", "b") else part.term.box[key]
                yield LawNumber(
                    f"{about.field}_{k}",
                    f"{key}_{k}",
                    self.ranges.unit if about.unit == "m" else about.unit,
                    about.meaning,
                    float(np.clip(value, low, high)),
                    low,
                    high,
                    about.log,
                )
            for j, value in part.heights.items():
                yield LawNumber(
                    f"height_{k}_{j + 1}",
                    f"h_{k}_{j + 1}",
                    "1",
                    f"height {j + 1} of the curve of term {k}, over its largest",
                    float(np.clip(value, -HEIGHT, HEIGHT)),
                    -HEIGHT,
                    HEIGHT,
                )

    def _held(self) -> Iterator[LawNumber]:
        texts = [inlined(self.named(k)) for k in range(self.terms)]
        if self.memory is not None:
            texts.append(inlined(self.memory[1].followed))
        words = set(re.findall(r"[A-Za-z_]\w*", " ".join(texts)))
        for name, (symbol, unit, meaning) in HELD.items():
            if name in words:
                value = float(getattr(self.ranges, name))
                room = self.ranges.half if name == "middle" else 0.5 * value
                own = self.ranges.unit if unit == "m" else unit
                yield LawNumber(name, symbol, own, meaning, value, value - room, value + room)


_PHASES = (-2.0 * math.pi, 2.0 * math.pi)


def law_of(draft: Draft, ranges: Ranges, size: float) -> Law:
    """The law of a draft; `size` is the effort's, as a torque."""
    pairs = list(zip(draft.terms, draft.factors, strict=True))
    of_drive = any(term.drives for term in draft.terms)
    if of_drive:  # of the factors of what it makes, the shares that it loses
        pairs = [(_lost(term), factors / ranges.strong) for term, factors in pairs]
    return Law(tuple(_part(term, factors) for term, factors in pairs), ranges, size, of_drive)


def _lost(term: Term) -> Term:
    return Term(tuple(shape for shape in term.shapes if shape.kind != DRIVE))


def _part(term: Term, factors: np.ndarray) -> Part:
    several = next((s for s in term.shapes if len(s.parts) > 1), None)
    numbers = dict(term.numbers)
    heights: dict[int, float] = {}
    if several is None:  # of several motors the mean
        mean, apart = float(np.mean(factors)), bool(factors.min() < 0.0 < factors.max())
        return Part(term, mean, _product(term, None, ""), numbers, heights, apart)
    if several.kind in WAVES:  # A·cos(x - φ) in place of its cosine and sine
        cosine = several.parts[0]
        key = "a" if several.of == "place" else "b"
        text = f"{cosine[:-1]} - {key})"
        numbers[key] = math.atan2(factors[1], factors[0])
        return Part(term, math.hypot(*factors), _product(term, several, text), numbers, heights)
    top = int(np.argmax(np.abs(factors)))
    texts = []
    for j, part in enumerate(several.parts):
        texts.append(part if j == top else f"h{j}*{part}")
        if j != top:
            heights[j] = float(factors[j] / factors[top])
    text = _product(term, several, " + ".join(texts))
    return Part(term, float(factors[top]), text, numbers, heights)


def _product(term: Term, several: Shape | None, text: str) -> str:
    """The product of a term's shapes, with `text` for the one that has several parts."""
    parts = [text if s is several else s.parts[0] for s in term.shapes]
    return parts[0] if len(parts) == 1 else "*".join(closed(p) for p in parts)


def inlined(text: str) -> str:
    """A text in the arguments of a kernel alone."""
    return re.sub(
        r"[A-Za-z_]\w*",
        lambda m: f"({SHORT[m.group()]})" if m.group() in SHORT else m.group(),
        text,
    )


def _renamed(text: str, names: Mapping[str, str]) -> str:
    return re.sub(r"[A-Za-z_]\w*", lambda m: names.get(m.group(), m.group()), text)


ROOM = 0.05  # of the range, beyond either end
SAID = {
    "winch.displacement": "place",
    "motor.angle": "angle",
    "motor.speed": "speed",
    "motor.load_torque": "load",
    "motor.current": "effort",
    "time": "time since a trial's beginning",
}


def beyond(
    problems: Sequence[InverseProblem],
    effects: Sequence[type[Effect]],
    changes: Mapping[str, float],
) -> list[str]:
    """Sentences, one for each signal of each law that leaves its range in some log."""
    said = []
    for effect in effects:
        for argument, (low, high) in effect.taught.items():
            signal = effect.reads[argument]
            shares = [_outside(p, changes, signal, low, high) for p in problems if signal in SAID]
            if any(shares):
                said.append(
                    f"{effect.name()}: the {SAID[signal]} leaves the range that taught this law, "
                    f"{low:.3g} to {high:.3g}, in up to {max(shares):.0%} of the time: there it "
                    "says nothing."
                )
    return said


def _outside(
    problem: InverseProblem, changes: Mapping[str, float], signal: str, low: float, high: float
) -> float:
    """Share of the compared samples of which a signal is outside of a range."""
    values, room = problem.thinned(problem.read(changes)[signal]), ROOM * (high - low)
    return float(np.mean((values < low - room) | (values > high + room)))
