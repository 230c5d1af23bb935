"""Current over displacement: how far the tendon comes, and what it costs.

Strokes are read at shares of the current's rise, and work is divided by the rise, so that neither
friction nor the efficiency of the gear enters.
"""

import numpy as np

from spirob.perceive.feature import feature
from spirob.perceive.wrap import Wrap


@feature("m")
def onset_stroke(wrap: Wrap) -> float:
    """Wound-in length at a tenth of the current's rise: the arm closes round the object."""
    return wrap.stroke_at(0.1)


@feature("m")
def knee_stroke(wrap: Wrap) -> float:
    """Wound-in length at a quarter of the current's rise."""
    return wrap.stroke_at(0.25)


@feature("m")
def half_rise_stroke(wrap: Wrap) -> float:
    """Wound-in length at half of the current's rise."""
    return wrap.stroke_at(0.5)


@feature("m")
def late_stroke(wrap: Wrap) -> float:
    """Wound-in length at three quarters of the current's rise."""
    return wrap.stroke_at(0.75)


@feature("m")
def end_stroke(wrap: Wrap) -> float:
    """Wound-in length at the plateau, the current that ends the wrap."""
    return wrap.end_stroke


@feature("m")
def rise_stroke(wrap: Wrap) -> float:
    """Wound-in length between a tenth and three quarters of the rise; a stiff contact has little."""
    return wrap.stroke_at(0.75) - wrap.stroke_at(0.1)


@feature("m")
def contact_work(wrap: Wrap) -> float:
    """Work ∫(i - i_free) dx from free motion to the end, over the current's rise."""
    part = slice(wrap.free.start, None)
    return float(np.trapezoid(wrap.share[part], wrap.delayed[part]))


@feature("m")
def winding_work(wrap: Wrap) -> float:
    """Work ∫i dx of the whole wrap, over the mean current of free motion."""
    return float(np.trapezoid(wrap.filtered, wrap.delayed) / np.mean(wrap.filtered[wrap.free]))


@feature("1/m")
def rise_slope(wrap: Wrap) -> float:
    """Slope di/dx from a tenth to half of the rise over the whole rise, least squares dx over di."""
    first, last = int(wrap.when(0.1)), int(wrap.when(0.5)) + 2
    share, stroke = wrap.share[first:last], wrap.delayed[first:last]
    # dx over di and not its inverse: a wrap that tightens without moving has no di/dx.
    softness = float(np.polyfit(share, stroke, 1)[0])
    return 1.0 / max(softness, 1e-4)


@feature("1")
def rise_ratio(wrap: Wrap) -> float:
    """Mean of the current over displacement in the last quarter of the stroke, over free motion's."""
    part = wrap.delayed >= 0.75 * wrap.end_stroke
    moving = part & (wrap.share < 0.9)
    if not moving.any():
        return 1.0
    late = np.mean(wrap.filtered[moving] / wrap.delayed[moving])
    return float(late / np.mean(wrap.filtered[wrap.free] / wrap.delayed[wrap.free]))
