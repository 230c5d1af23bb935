"""Reference profiles made of sine waves, faded in within the blend."""

from dataclasses import dataclass

import numpy as np

from spirob.bench.blend import step
from spirob.bench.profile import Profile, number


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
