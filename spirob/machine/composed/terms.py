"""What a law is made of: terms, each an amplitude times one or two shapes without a unit.

Units hold by construction.  A shape is a text in the names of `track`; the same text is
evaluated along a motion, stands in the equation of a written law, and in its kernel.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from spirob.machine.composed.track import MEMORIES, Ranges, Track, evaluated

WAY = "way"  # the kind of a direction
DRIVE = "drive"  # the kind of what the drive makes: a share of it is lost


@dataclass(frozen=True)
class Number:
    """A number of a shape: what it is called, its unit, whether it spans decades."""

    field: str
    symbol: str
    unit: str
    meaning: str
    log: bool = True


NUMBERS = {
    "c": Number("centre", "c", "m", "place of its middle", log=False),
    "w": Number("width", "w", "m", "half width of the spot"),
    "L": Number("pitch", "L", "m", "way after which the wave comes round"),
    "g": Number("growth", "g", "1", "of the waves a way, half the way from the centre", log=False),
    "a": Number("phase", "a", "1", "angle of the wave where its place is 0", log=False),
    "p": Number("power", "p", "1", "power of the speed", log=False),
    "f": Number("fading_speed", "f", "rad/s", "speed at which it has faded"),
    "s": Number("half_speed", "s", "rad/s", "speed at which half of it is there"),
    "T": Number("period", "T", "s", "time after which it comes again"),
    "b": Number("start", "b", "1", "angle of the wave at time 0", log=False),
    "d": Number("decay", "d", "s", "time in which it decays"),
    "r": Number("reach", "r", "rad", "way over which it turns round"),
    "m": Number("drag", "m", "1", "friction at the fastest, of the largest load", log=False),
    "u": Number("half_load", "u", "1", "of the largest load, at which half of it is there"),
    "n": Number("exponent", "n", "1", "power of the effort", log=False),
    "h": Number("half_effort", "h", "1", "of the largest effort, at which half of it is there"),
    "z": Number("dead_band", "z", "1", "of the largest effort, which is lost"),
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
    def drives(self) -> bool:
        """Whether it is a share of the drive's torque that is lost, and no torque beside it."""
        return DRIVE in self.kinds

    @property
    def richness(self) -> int:
        """Numbers, amplitudes included, and memories."""
        return len(self.numbers) + len(self.parts) + (self.memory is not None)

    def at(self, values: Mapping[str, float]) -> "Term":
        """The same with other numbers of its shapes."""
        return Term(tuple(s.at(values) for s in self.shapes))

    def bristled(self, reach: float, box: tuple[float, float]) -> "Term | None":
        """The same with a bristle for its direction: it turns round over a way, not at a speed.

        None where it has no direction, is of a drive, or remembers already.
        """
        for k, shape in enumerate(self.shapes):
            parts = tuple(re.sub(r"\bway\b", "bend", part) for part in shape.parts)
            if self.memory is None and not self.drives and parts != shape.parts:
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
            own = dict(shape.numbers)
            numbers = [own[key] for key in MEMORIES[shape.memory].numbers.values()]
            known |= track.remembered(shape.memory, followed, numbers)
        n = len(track.signals["speed"])
        return [np.broadcast_to(_evaluated(part, known), (n,)) for part in self.parts]


LOST = Shape(DRIVE, "effort", ("drive",))  # all that a drive makes: times a share of it


def _evaluated(text: str, known: Mapping[str, object]) -> np.ndarray:
    return np.asarray(evaluated(text, known), dtype=float)


def closed(text: str) -> str:
    return f"({text})" if any(mark in text for mark in " +-*/") else text
