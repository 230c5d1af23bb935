"""What a reference profile is, and how its jumps and kinks are blended.

The unit of its value is that of the feedback mode: A, m/s, m or N.  `blend` [s] is the time in
which a jump or a kink is rounded; every profile starts from 0.

Straight lines are smoothed: every jump and every kink becomes a short cosine blend.  The line is
kept as its events.  An event at t_j that jumps by a and changes the slope by s adds

    a·S(t - t_j) + s·R(t - t_j),   S(u) = u/b - sin(2πu/b)/(2π),  R = ∫S,   0 <= u <= b

S is the integral of a raised cosine of width b, so this is the line averaged over the last b
seconds: it stays within the line's bounds and keeps its integral, half a blend late.
"""

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields
from typing import Any, ClassVar

import numpy as np

from spirob.errors import ConfigError


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


def profile_from(given: Any, mode: str, where: str) -> Profile:
    """A profile from plain data `{kind: sine, amplitude: 0.02, ...}`.

    Raises ConfigError; `where` names the trial and the key.
    """
    if not isinstance(given, Mapping) or "kind" not in given:
        raise ConfigError(f"{where} must be a mapping with the key 'kind', not {given!r}")
    if given["kind"] not in PROFILES:
        known = ", ".join(PROFILES)
        raise ConfigError(f"{where}.kind '{given['kind']}' is unknown; known: {known}")
    chosen = PROFILES[given["kind"]]
    if mode not in chosen.modes:
        modes = ", ".join(chosen.modes)
        raise ConfigError(f"{where}: '{given['kind']}' is for mode {modes}, not '{mode}'")
    known_keys = {about.name: about for about in fields(chosen)}
    for key in given:
        if key != "kind" and key not in known_keys:
            listed = ", ".join(known_keys)
            raise ConfigError(f"{where} has no key '{key}'; {given['kind']} has: {listed}")
    for key, about in known_keys.items():
        if about.default is MISSING and key not in given:
            raise ConfigError(f"{where} needs '{key}' for {given['kind']}")
    try:
        profile = chosen(**{key: value for key, value in given.items() if key != "kind"})
        profile(np.zeros(1))
    except ValueError as error:
        raise ConfigError(f"{where}: {error}") from error
    return profile


def check(name: str, value: Any, low: float = -np.inf, above: bool = False) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise ValueError(f"'{name}' must be a finite number, not {value!r}")
    if value < low or (above and value == low):
        raise ValueError(f"'{name}' = {value} must be {'above' if above else 'at least'} {low}")
