"""Reference profiles made of straight lines: plateaus, ramps, triangles and journeys."""

from dataclasses import dataclass
from typing import ClassVar

from spirob.bench.blend import Event
from spirob.bench.profile import Profile, check, number


@dataclass(frozen=True, kw_only=True)
class Constant(Profile):
    """One value throughout."""

    value: float = number()

    def events(self, duration: float) -> list[Event]:
        return [Event(0.0, self.value)]


@dataclass(frozen=True, kw_only=True)
class Ramp(Profile):
    """From `start` to `end` between two times [s], held before and after."""

    start: float = number(default=0.0)
    end: float = number()
    begins: float = number(0.0, 0.0)
    ends: float = number(0.0, above=True)

    def events(self, duration: float) -> list[Event]:
        if self.ends <= self.begins:
            raise ValueError("'ends' must come after 'begins'")
        slope = (self.end - self.start) / (self.ends - self.begins)
        line = [Event(self.begins, 0.0, slope), Event(self.ends, 0.0, -slope)]
        return [Event(0.0, self.start), *line]


@dataclass(frozen=True, kw_only=True)
class Steps(Profile):
    """Plateaus as pairs [duration, value]; the last value is held."""

    plateaus: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.plateaus, list | tuple) or not self.plateaus:
            raise ValueError("'plateaus' must be a list of pairs [duration, value]")
        for pair in self.plateaus:
            if not isinstance(pair, list | tuple) or len(pair) != 2:
                raise ValueError(f"'plateaus' must hold pairs [duration, value], not {pair!r}")
            check("plateaus: duration", pair[0], 0.0, above=True)
            check("plateaus: value", pair[1])

    def events(self, duration: float) -> list[Event]:
        out, time, level = [], 0.0, 0.0
        for lasts, value in self.plateaus:
            out.append(Event(time, value - level))
            time, level = time + lasts, value
        return out


@dataclass(frozen=True, kw_only=True)
class Triangle(Profile):
    """Straight up and down between `low` and `high`, starting at `low`; period [s]."""

    low: float = number(default=0.0)
    high: float = number()
    period: float = number(0.01)

    def events(self, duration: float) -> list[Event]:
        half = self.period / 2
        slope = (self.high - self.low) / half
        turns = [
            Event(k * half, 0.0, -2 * slope if k % 2 else 2 * slope)
            for k in range(1, int(duration / half) + 1)
        ]
        return [Event(0.0, self.low, slope), *turns]


@dataclass(frozen=True, kw_only=True)
class Shuttle(Profile):
    """Velocity in and out again: +speed over the stroke, dwell, -speed back, dwell, and so on.

    speeds   [m/s] one a journey there and back, in turn;  stroke [m];  dwell [s] at each end
    start    [s] of rest before the first journey

    The stroke comes out exactly, because blending keeps the integral.
    """

    modes: ClassVar[tuple[str, ...]] = ("velocity",)
    speeds: tuple[float, ...]
    stroke: float = number(0.0, above=True)
    dwell: float = number(0.0, 0.5)
    start: float = number(0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.speeds, list | tuple) or not self.speeds:
            raise ValueError("'speeds' must be a list of speeds")
        for speed in self.speeds:
            check("speeds", speed, 1e-6)
            if self.stroke / speed < self.blend:
                raise ValueError(f"a stroke at {speed} m/s is over before its blend is")

    def events(self, duration: float) -> list[Event]:
        out, time, journey = [], self.start, 0
        while time <= duration:
            speed = self.speeds[journey // 2 % len(self.speeds)]
            jump = speed if journey % 2 == 0 else -speed
            lasts = self.stroke / speed
            out += [Event(time, jump), Event(time + lasts, -jump)]
            time, journey = time + lasts + max(self.dwell, 1e-3), journey + 1
        return out
