"""When things happen, counted from the start of the motion, in free-running seconds.

A time is multiplied by the free speed and divided by the nominal one: a trial that runs 5 % faster
reaches the same stroke 5 % earlier, and its clock should not tell that as another size.
"""

import numpy as np

from spirob.perceive.wrap import Wrap, feature

NOMINAL_SPEED = 0.045  # m/s


def _seconds(wrap: Wrap, samples: float) -> float:
    return samples * wrap.period * wrap.free_speed / NOMINAL_SPEED


@feature("s")
def onset_time(wrap: Wrap) -> float:
    """Time until a tenth of the current's rise."""
    return _seconds(wrap, wrap.when(0.1))


@feature("s")
def half_rise_time(wrap: Wrap) -> float:
    """Time until half of the current's rise."""
    return _seconds(wrap, wrap.when(0.5))


@feature("s")
def rise_time(wrap: Wrap) -> float:
    """Time from a tenth to nine tenths of the current's rise."""
    return _seconds(wrap, wrap.when(0.9) - wrap.when(0.1))


@feature("s")
def stall_time(wrap: Wrap) -> float:
    """Time until the velocity stays below half of the free velocity."""
    fast = np.flatnonzero(wrap.velocity >= 0.5 * wrap.free_speed)
    return _seconds(wrap, float(fast[-1] + 1) if len(fast) else 0.0)
