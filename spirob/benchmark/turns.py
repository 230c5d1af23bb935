"""Time several things in turns."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Size:
    """How much to measure: trial length [s], repeats of quick and of slow things."""

    seconds: float = 2.0
    repeats: int = 21
    slow_repeats: int = 3


TINY = Size(seconds=0.4, repeats=1, slow_repeats=1)


def in_turns(work: Mapping[str, Callable[[], object]], repeats: int) -> dict[str, np.ndarray]:
    """Seconds of each piece of work in each round, after one round that does not count."""
    for run in work.values():
        run()
    taken: dict[str, list[float]] = {name: [] for name in work}
    for _ in range(repeats):
        for name, run in work.items():
            start = time.perf_counter()
            run()
            taken[name].append(time.perf_counter() - start)
    return {name: np.array(times) for name, times in taken.items()}


def ratio(taken: Mapping[str, np.ndarray], over: str, under: str) -> float:
    """Median over rounds of the ratio of two pieces of work timed side by side."""
    return float(np.median(taken[over] / taken[under]))
