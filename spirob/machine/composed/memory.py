"""Memories of a law: bristles that turn round over a way, and what follows a signal slowly.

Each is advanced exactly over a step, along a motion here and, in the same words, in a written law.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import njit


@dataclass(frozen=True)
class Memory:
    """One kind of memory.

    lines      that advance `name` over `dt` in a kernel; {reach} is its number
    evolution  rate of change, in the same names;  run  the same along a signal, (n,)
    """

    name: str
    lines: tuple[str, ...]
    evolution: str
    run: Callable[..., None]


@njit(cache=True)
def _bristle(out, followed, reach, starts, steps):
    for piece in range(len(starts) - 1):
        state = 0.0
        for k in range(starts[piece], starts[piece + 1]):
            end = 1.0 if followed[k] > 0.0 else -1.0
            state = end + (state - end) * np.exp(-abs(followed[k]) * steps[piece] / reach)
            out[k] = state


@njit(cache=True)
def _spring(out, followed, reach, starts, steps):
    for piece in range(len(starts) - 1):
        state = 0.0
        for k in range(starts[piece], starts[piece + 1]):
            end = 1.0 if followed[k] > 0.0 else -1.0
            path = abs(followed[k]) * steps[piece] / reach
            free = max(0.0, min(path, -end * state))
            bent = np.tanh(path - free)
            ahead = end * state + free
            state = end * (ahead if path <= free else (ahead + bent) / (1.0 + ahead * bent))
            out[k] = state


@njit(cache=True)
def _slow(out, followed, reach, starts, steps):
    for piece in range(len(starts) - 1):
        state = 0.0
        for k in range(starts[piece], starts[piece + 1]):
            state = followed[k] + (state - followed[k]) * np.exp(-steps[piece] / reach)
            out[k] = state


MEMORIES = {
    # Dahl: the way back is bent as the way there
    "bristle": Memory(
        "bend",
        (
            "end = 1.0 if speed > 0.0 else -1.0",
            "bend = end + (bend - end) * exp(-Abs(speed) * dt / {reach})",
        ),
        "(speed - Abs(speed)*bend)/{reach}",
        _bristle,
    ),
    # Bouc and Wen: springs back straight, then yields
    "spring": Memory(
        "bend",
        (
            "end = 1.0 if speed > 0.0 else -1.0",
            "path = Abs(speed) * dt / {reach}",
            "free = Max(0.0, Min(path, -end * bend))",
            "bent = tanh(path - free)",
            "ahead = end * bend + free",
            "bend = end * (ahead if path <= free else (ahead + bent) / (1.0 + ahead * bent))",
        ),
        "speed*(1.0 - bend**2*(0.5 + 0.5*sign(speed*bend)))/{reach}",
        _spring,
    ),
    "slow": Memory(
        "slow",
        ("slow = ({followed}) + (slow - ({followed})) * exp(-dt / {reach})",),
        "(({followed}) - slow)/{reach}",
        _slow,
    ),
}


def along(
    kind: str, followed: np.ndarray, reach: float, starts: np.ndarray, steps: np.ndarray
) -> np.ndarray:
    """The memory after each sample, (n,); `followed` is the speed of a bristle."""
    out = np.empty(len(followed))
    MEMORIES[kind].run(out, np.ascontiguousarray(followed, float), reach, starts, steps)
    return out
