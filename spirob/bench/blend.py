"""Piecewise straight lines, smoothed: every jump and every kink becomes a short cosine blend.

The line is kept as its events.  An event at t_j that jumps by a and changes the slope by s adds

    a·S(t - t_j) + s·R(t - t_j),   S(u) = u/b - sin(2πu/b)/(2π),  R = ∫S,   0 <= u <= b

S is the integral of a raised cosine of width b, so this is the line averaged over the last b
seconds: it stays within the line's bounds and keeps its integral, half a blend late.
"""

from dataclasses import dataclass

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
