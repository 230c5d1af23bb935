"""What a law is made of: terms, each an amplitude times one or two shapes without a unit.

Units hold by construction.  A shape is a text in the names of `track`; the same text is
evaluated along a motion, stands in the equation of a written law, and in its kernel.

A law is composed among shapes of one signal and products of two.  A place may be a power, a spot, a
wave or a curve; a speed has its direction, powers, fading and saturation; time drifts, comes again
or decays; a load counts with sign or without; and what remembers is a bristle, a spring that
yields, or what follows a signal slowly.  Numbers of a shape start from a grid; those of waves where
the residual's spectrum has peaks.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from spirob.diagnosis.orders import peaks
from spirob.machine.composed.track import Ranges, Track, evaluated

KNOTS = "k"  # of a curve


@dataclass(frozen=True)
class Number:
    """A number of a shape: what it is called, its unit, whether it spans decades."""

    field: str
    symbol: str
    unit: str
    meaning: str
    log: bool = True


NUMBERS = {
    "c": Number("centre", "c", "m", "place of the middle of the spot", log=False),
    "w": Number("width", "w", "m", "half width of the spot"),
    "L": Number("pitch", "L", "m", "way after which the wave comes round"),
    "a": Number("phase", "a", "1", "angle of the wave at place 0", log=False),
    "p": Number("power", "p", "1", "power of the speed", log=False),
    "f": Number("fading_speed", "f", "rad/s", "speed at which it has faded"),
    "s": Number("half_speed", "s", "rad/s", "speed at which half of it is there"),
    "T": Number("period", "T", "s", "time after which it comes again"),
    "b": Number("start", "b", "1", "angle of the wave at time 0", log=False),
    "d": Number("decay", "d", "s", "time in which it decays"),
    "r": Number("reach", "r", "rad", "way over which it turns round"),
    "e": Number("delay", "e", "s", "time in which it follows"),
}


@dataclass(frozen=True)
class Shape:
    """A function of one signal, without a unit.

    kind    in `words`;  of  the signal: place, speed, time, load or memory
    parts   texts whose sum, each with a factor of its own, it is; mostly one
    numbers by their key in `NUMBERS`
    box     lowest and highest value of each number
    memory  kind in `memory`, with the text that it follows
    """

    kind: str
    of: str
    parts: tuple[str, ...]
    numbers: tuple[tuple[str, float], ...] = ()
    box: tuple[tuple[float, float], ...] = ()
    memory: str = ""
    followed: str = ""

    def at(self, values: Mapping[str, float]) -> "Shape":
        """The same with other numbers, within their box."""
        kept = [
            (key, float(np.clip(values.get(key, old), low, high)))
            for (key, old), (low, high) in zip(self.numbers, self.box, strict=True)
        ]
        return replace(self, numbers=tuple(kept))


@dataclass(frozen=True)
class Term:
    """A product of shapes."""

    shapes: tuple[Shape, ...]

    @property
    def kinds(self) -> tuple[str, ...]:
        """What its shapes are called."""
        return tuple(s.kind for s in self.shapes)

    @property
    def numbers(self) -> dict[str, float]:
        """Those of its shapes, by key."""
        return {key: value for s in self.shapes for key, value in s.numbers}

    @property
    def box(self) -> dict[str, tuple[float, float]]:
        """Lowest and highest of each."""
        return {
            key: box for s in self.shapes for (key, _), box in zip(s.numbers, s.box, strict=True)
        }

    @property
    def parts(self) -> list[str]:
        """Texts of its columns: of a product, one for each part of the shape that has several."""
        made = ["1.0"]
        for shape in self.shapes:
            made = [f"{a}*{closed(b)}" if a != "1.0" else b for a in made for b in shape.parts]
        return made

    @property
    def memory(self) -> Shape | None:
        """Its shape that remembers."""
        return next((s for s in self.shapes if s.memory), None)

    @property
    def richness(self) -> int:
        """Numbers, amplitudes included, and memories."""
        return len(self.numbers) + len(self.parts) + (self.memory is not None)

    def at(self, values: Mapping[str, float]) -> "Term":
        """The same with other numbers of its shapes."""
        return Term(tuple(s.at(values) for s in self.shapes))

    def bristled(self, reach: float, box: tuple[float, float]) -> "Term | None":
        """The same with a bristle for its direction: it turns round over a way, not at a speed.

        None where it has no direction, or remembers already.
        """
        for k, shape in enumerate(self.shapes):
            parts = tuple(re.sub(r"\bway\b", "bend", part) for part in shape.parts)
            if self.memory is None and parts != shape.parts:
                turned = replace(
                    shape,
                    kind="bristle" if shape.kind == "way" else shape.kind,
                    parts=parts,
                    numbers=(*shape.numbers, ("r", reach)),
                    box=(*shape.box, box),
                    memory="bristle",
                    followed="speed",
                )
                return Term((*self.shapes[:k], turned, *self.shapes[k + 1 :]))
        return None

    def along(self, track: Track, ranges: Ranges) -> list[np.ndarray]:
        """Each of its parts along the motion, (n,)."""
        known = {**track.values(ranges), **self.numbers}
        if (shape := self.memory) is not None:
            followed = _evaluated(shape.followed, known)
            reach = dict(shape.numbers)["e" if shape.memory == "slow" else "r"]
            kept = track.remembered(shape.memory, followed, reach)
            known |= {"slow" if shape.memory == "slow" else "bend": kept}
        n = len(track.signals["speed"])
        return [np.broadcast_to(_evaluated(part, known), (n,)) for part in self.parts]


def _evaluated(text: str, known: Mapping[str, object]) -> np.ndarray:
    return np.asarray(evaluated(text, known), dtype=float)


def closed(text: str) -> str:
    return f"({text})" if any(mark in text for mark in " +-*/") else text


SPOTS, WIDTHS = 16, (0.06, 0.15, 0.35)  # places of a spot; its half widths over half of the way
FINEST = 100.0  # waves in the way
CURVES = (6, 12, 24)  # knots
SPEEDS = (0.08, 0.2, 0.5)  # of the fastest, at which something fades or is half there
POWERS = (0.3, 0.6, 1.5)
PERIODS = (0.5, 0.8, 1.2, 1.8)  # of the longest trial
DECAYS = (0.1, 0.3, 1.0)  # of the same
WAYS = (0.01, 0.03, 0.1, 0.3, 0.8)  # of half of the way, in which a bristle turns round
SHORT_WAYS = WAYS[:3]
DELAYS = (0.01, 0.05, 0.2)  # of the longest trial
WAY = "way"


def _one(kind: str, of: str, *parts: str) -> Shape:
    return Shape(kind, of, parts)


DIRECTION = _one(WAY, "speed", "way")
PLAIN = {
    "line": _one("line", "speed", "line"),
    "share": _one("share", "speed", "share"),
    "drag": _one("drag", "speed", "way*share**2"),
    "lift": _one("lift", "speed", "share**2"),
    "steady": _one("steady", "", "1.0"),
    "far": _one("far", "place", "away"),
    "far2": _one("far2", "place", "away**2"),
    "far3": _one("far3", "place", "away**3"),
    "cubic": _one("cubic", "place", "away", "away**2", "away**3"),
    "late": _one("late", "time", "late"),
    "late2": _one("late2", "time", "late**2"),
    "weight": _one("weight", "load", "Abs(pull)"),
    "pull": _one("pull", "load", "pull"),
    "hard": _one("hard", "load", "pull*pull**2"),
}


def terms(
    ranges: Ranges, residual: np.ndarray, signals: dict[str, np.ndarray], placed: bool
) -> list[Term]:
    """All terms from which a law may begin.

    residual  (N,) that is to be explained;  signals  `place`, `speed` and so on along it
    """
    odd, even = _speeds(ranges, odd=True), _speeds(ranges, odd=False)
    places = _places(ranges, residual, signals) if placed else []
    times = _times(ranges)
    found = [Term((s,)) for s in (PLAIN["steady"], *odd, *even)]
    found += [Term((s,)) for s in (*places, *times)]
    for speed in (DIRECTION, PLAIN["line"], PLAIN["share"]):
        carried = _carried(speed, ranges, residual, signals)
        own = _places(ranges, carried, signals) if placed else []
        found += [Term((speed, s)) for s in (*own, *times)]
    found += _loads(ranges) + _memories(ranges, placed)
    return found


def _carried(
    speed: Shape, ranges: Ranges, residual: np.ndarray, signals: dict[str, np.ndarray]
) -> np.ndarray:
    """The residual times what multiplies a shape of the place, whose spectrum shows its waves."""
    v = signals["speed"]
    return residual * (np.abs(v) if speed.kind == "share" else np.tanh(v / ranges.rest_speed))


def _speeds(ranges: Ranges, odd: bool) -> list[Shape]:
    fast = ranges.fast
    wide = (ranges.rest_speed, 2.0 * fast)

    def made(kind: str, text: str, key: str, value: float, box: tuple[float, float]) -> Shape:
        whole = f"way*{text}" if odd else text
        return Shape(kind if odd else f"even {kind}", "speed", (whole,), ((key, value),), (box,))

    found = [DIRECTION, PLAIN["drag"]] if odd else [PLAIN["share"], PLAIN["lift"]]
    found += [made("power", "share**p", "p", p, (0.05, 4.0)) for p in POWERS]
    found += [made("fading", "exp(-(speed/f)**2)", "f", s * fast, wide) for s in SPEEDS]
    found += [made("settling", "Abs(speed)/(Abs(speed) + s)", "s", s * fast, wide) for s in SPEEDS]
    return found


def _places(ranges: Ranges, residual: np.ndarray, signals: dict[str, np.ndarray]) -> list[Shape]:
    middle, half = ranges.middle, ranges.half
    found = [PLAIN["far"], PLAIN["far2"], PLAIN["far3"], PLAIN["cubic"]]
    round_again = 0.0 < ranges.turn < 2 * half
    text = "exp(-0.5*((place - c)/w)**2)"
    if round_again:
        text = "exp(-0.5*(turn*sin(pi*(place - c)/turn)/(pi*w))**2)"
    way = min(ranges.turn / 2 if round_again else half, half)
    box = (middle - half, middle + half), (0.02 * way, way)
    for centre in np.linspace(middle - half, middle + half, SPOTS + 2)[1:-1]:
        for width in WIDTHS:
            numbers = ("c", float(centre)), ("w", width * way)
            found.append(
                Shape("turning spot" if round_again else "spot", "place", (text,), numbers, box)
            )
    low, high = 2 * np.pi / (2 * half), FINEST * 2 * np.pi / (2 * half)
    box_of = ((2 * half / FINEST, 4 * half),)
    for order in peaks(residual, signals["place"], 0.5 * low, high):
        parts = "cos(2*pi*place/L)", "sin(2*pi*place/L)"
        found.append(Shape("wave", "place", parts, (("L", 2 * np.pi / order),), box_of))
    return found + [curve(count) for count in CURVES]


def curve(count: int) -> Shape:
    """A smooth curve over the way through so many heights, evenly apart."""
    at = f"{0.5 * (count - 1)!r}*(far + 1.0)"
    parts = [f"(0.5 + 0.5*cos(pi*Max(-1.0, Min(1.0, {at} - {float(k)!r}))))" for k in range(count)]
    return Shape(f"curve {KNOTS}{count}", "place", tuple(parts))


def _times(ranges: Ranges) -> list[Shape]:
    long = ranges.long
    found = [PLAIN["late"], PLAIN["late2"]]
    waves = "cos(2*pi*time/T)", "sin(2*pi*time/T)"
    box = ((0.05 * long, 2.0 * long),)
    found += [Shape("tide", "time", waves, (("T", p * long),), box) for p in PERIODS]
    box = ((0.01 * long, 3.0 * long),)
    found += [Shape("decay", "time", ("exp(-time/d)",), (("d", d * long),), box) for d in DECAYS]
    return found


def _loads(ranges: Ranges) -> list[Term]:
    odd, even = _speeds(ranges, odd=True), _speeds(ranges, odd=False)
    weight, pull = PLAIN["weight"], PLAIN["pull"]
    return [
        Term((weight,)),
        Term((pull,)),
        Term((PLAIN["hard"],)),
        *(Term((weight, s)) for s in odd),
        *(Term((pull, s)) for s in even),
        *(Term((pull, PLAIN[name])) for name in ("late", "late2")),
    ]


def _memories(ranges: Ranges, placed: bool) -> list[Term]:
    half, long = ranges.half * ranges.gear if placed else ranges.fast, ranges.long
    found = []
    for kind in ("bristle", "spring"):
        for way in WAYS:
            numbers, box = (("r", way * half),), (_reach(half),)
            shape = Shape(kind, "memory", ("bend",), numbers, box, kind, "speed")
            found.append(Term((shape,)))
            if kind == "bristle":
                found.append(Term((shape, PLAIN["weight"])))
    box = ((0.001 * long, 3.0 * long),)
    followed = {"way": "direction", "share": "speed", "pull": "load", "pull*pull": "heat"}
    followed |= {"away": "place"} if placed else {}
    for text, name in followed.items():
        for delay in DELAYS:
            numbers = (("e", delay * long),)
            shape = Shape(f"slow {name}", "memory", ("slow",), numbers, box, "slow", text)
            found.append(Term((shape,)))
            if name == "heat":
                found.append(Term((shape, PLAIN["pull"])))
    return found


def bristled(term: Term, ranges: Ranges) -> list[Term]:
    """The term with bristles of several short ways for its direction, none where it has none."""
    half = ranges.half * ranges.gear
    found = [term.bristled(way * half, _reach(half)) for way in SHORT_WAYS]
    return [one for one in found if one is not None]


def _reach(half: float) -> tuple[float, float]:
    return 0.0005 * half, 4.0 * half
