"""Reference profiles: what one is, and plateaus, ramps, triangles, journeys, smooth moves, tones.

The unit of its value is that of the feedback mode: A, m/s, m or N.  `blend` [s] is the time in
which a jump or a kink is rounded; every profile starts from 0.

Straight lines are smoothed: every jump and every kink becomes a short cosine blend.  The line is
kept as its events.  An event at t_j that jumps by a and changes the slope by s adds

    a·S(t - t_j) + s·R(t - t_j),   S(u) = u/b - sin(2πu/b)/(2π),  R = ∫S,   0 <= u <= b

S is the integral of a raised cosine of width b, so this is the line averaged over the last b
seconds: it stays within the line's bounds and keeps its integral, half a blend late.
"""

from dataclasses import MISSING, dataclass, field, fields
from typing import Any, ClassVar

import numpy as np


@dataclass(frozen=True)
class Event:
    """At `time` [s] the value jumps by `jump` and its rate by `slope`."""

    time: float
    jump: float = 0.0
    slope: float = 0.0


def step(u: np.ndarray, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Smooth step from 0 to 1 within `width` [s], and its rate; sharp where width is 0."""
    if width <= 0:
        return (u >= 0).astype(float), np.zeros_like(u)
    phase = np.clip(u / width, 0.0, 1.0)
    value = phase - np.sin(2 * np.pi * phase) / (2 * np.pi)
    return value, (1 - np.cos(2 * np.pi * phase)) / width


def follow(events: list[Event], t: np.ndarray, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Value and rate at sorted times `t` of the line that starts at 0 and meets these events."""
    value, rate = np.zeros_like(t), np.zeros_like(t)
    for event in events:
        first = int(np.searchsorted(t, event.time))  # before its time an event adds nothing
        u = t[first:] - event.time
        level, slope = step(u, width)
        value[first:] += event.jump * level + event.slope * _ramp(u, width)
        rate[first:] += event.jump * slope + event.slope * level
    return value, rate


def _ramp(u: np.ndarray, width: float) -> np.ndarray:
    if width <= 0:
        return u
    phase = np.clip(u / width, 0.0, 1.0)
    bend = phase**2 / 2 - (1 - np.cos(2 * np.pi * phase)) / (4 * np.pi**2)
    return width * bend + np.maximum(u - width, 0.0)


PROFILES: dict[str, type["Profile"]] = {}


def number(low: float = -np.inf, default: float | None = None, above: bool = False) -> Any:
    """A finite number, not below `low`, or strictly above it."""
    limits = {"low": low, "above": above}
    return field(default=MISSING if default is None else default, metadata=limits)


@dataclass(frozen=True, kw_only=True)
class Profile:
    """Base of all profiles; a subclass registers itself under its name in lower case."""

    modes: ClassVar[tuple[str, ...]] = ("current", "velocity", "displacement", "force")
    blend: float = number(0.0, 0.05)

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        PROFILES[cls.__name__.lower()] = cls

    def __post_init__(self) -> None:
        for about in fields(self):
            if "low" in about.metadata:
                check(about.name, getattr(self, about.name), **about.metadata)

    def events(self, duration: float) -> list[Event]:
        """Jumps and kinks up to `duration` [s], of a profile made of straight lines."""
        raise NotImplementedError

    def __call__(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value and rate [value/s] at times t [s], sorted, from 0."""
        return follow(self.events(float(t[-1]) if len(t) else 0.0), t, self.blend)


def check(name: str, value: Any, low: float = -np.inf, above: bool = False) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise ValueError(f"'{name}' must be a finite number, not {value!r}")
    if value < low or (above and value == low):
        raise ValueError(f"'{name}' = {value} must be {'above' if above else 'at least'} {low}")


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


@dataclass(frozen=True, kw_only=True)
class Moves(Profile):
    """Half-cosine moves as pairs [duration, target]; repeat a target to hold.

    x(t) = x_0 + (x_1 - x_0)(1 - cos πu)/2,  u = t/duration.  Acceleration is finite and small,
    so that a geared antagonist, kilograms seen at its tendon, can follow without going slack.
    """

    waypoints: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        pairs: Any = self.waypoints
        if not isinstance(pairs, list | tuple) or not pairs:
            raise ValueError("'waypoints' must be a list of pairs [duration, target]")
        for pair in pairs:
            if not isinstance(pair, list | tuple) or len(pair) != 2:
                raise ValueError(f"'waypoints' must hold pairs [duration, target], not {pair!r}")
            check("waypoints: duration", pair[0], 0.0, above=True)
            check("waypoints: target", pair[1])

    def __call__(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, rate = np.zeros_like(t), np.zeros_like(t)
        begins, level = 0.0, 0.0
        for lasts, target in self.waypoints:
            u = np.clip((t - begins) / lasts, 0.0, 1.0)
            moving = (t >= begins) & (t < begins + lasts)
            value += (target - level) * (1 - np.cos(np.pi * u)) / 2
            rate += moving * (target - level) * np.pi / (2 * lasts) * np.sin(np.pi * u)
            begins, level = begins + lasts, float(target)
        return value, rate


@dataclass(frozen=True, kw_only=True)
class Sine(Profile):
    """offset + amplitude·sin(2π·frequency·t + phase); frequency [Hz], phase [rad]."""

    amplitude: float = number(0.0)
    frequency: float = number(0.0, above=True)
    phase: float = number(default=0.0)
    offset: float = number(default=0.0)

    def __call__(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        turn = 2 * np.pi * self.frequency
        wave = self.offset + self.amplitude * np.sin(turn * t + self.phase)
        slope = self.amplitude * turn * np.cos(turn * t + self.phase)
        return _fade_in(wave, slope, t, self.blend)


@dataclass(frozen=True, kw_only=True)
class Multisine(Profile):
    """Equal tones in a band [low, high] Hz, phases drawn from `seed`, at most `amplitude` high.

    The tones are multiples of 1/period, `count` of them spread evenly over the band.
    """

    amplitude: float = number(0.0)
    low: float = number(0.0, above=True)
    high: float = number(0.0, above=True)
    count: float = number(1, 12)
    period: float = number(0.0, 10.0, above=True)
    seed: float = number(0, 0)
    offset: float = number(default=0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if int(self.count) != self.count or int(self.seed) != self.seed:
            raise ValueError("'count' and 'seed' must be whole numbers")
        if len(self.harmonics) == 0 or self.high * self.period > 1e5:
            raise ValueError(
                f"the band {self.low}..{self.high} Hz must hold between one and 100 000 "
                f"multiples of 1/period = {1 / self.period:g} Hz"
            )

    @property
    def harmonics(self) -> np.ndarray:
        """Which multiples of 1/period sound."""
        lowest = int(np.ceil(self.low * self.period - 1e-9))
        highest = int(np.floor(self.high * self.period + 1e-9))
        if highest < lowest:
            return np.array([], int)
        return np.unique(np.rint(np.linspace(lowest, highest, int(self.count))).astype(int))

    def __call__(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        harmonics = self.harmonics
        phases = np.random.default_rng(int(self.seed)).uniform(0, 2 * np.pi, len(harmonics))
        samples = 16 * int(harmonics[-1])
        grid = self._tones(np.arange(samples) * (self.period / samples), harmonics, phases)[0]
        # Between samples a trigonometric polynomial of degree n exceeds its samples by at most
        # 1/cos(πn/N), so the peak is bounded for sure and not only on the grid.
        peak = np.abs(grid).max() / np.cos(np.pi / 16)
        value, rate = self._tones(t, harmonics, phases)
        scale = self.amplitude / peak
        return _fade_in(self.offset + scale * value, scale * rate, t, self.blend)

    def _tones(
        self, t: np.ndarray, harmonics: np.ndarray, phases: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        value, rate = np.zeros_like(t), np.zeros_like(t)
        for harmonic, phase in zip(harmonics, phases, strict=True):
            turn = 2 * np.pi * harmonic / self.period
            value += np.cos(turn * t + phase)
            rate -= turn * np.sin(turn * t + phase)
        return value, rate


def _fade_in(
    value: np.ndarray, rate: np.ndarray, t: np.ndarray, width: float
) -> tuple[np.ndarray, np.ndarray]:
    level, slope = step(t, width)
    return level * value, level * rate + slope * value
