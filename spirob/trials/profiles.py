"""Reference profiles: plateaus, ramps, triangles, journeys, smooth moves, tones."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from spirob.trials.profile import Event, Profile, check, number, step


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
