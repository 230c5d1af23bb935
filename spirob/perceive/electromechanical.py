"""Current over displacement: how far the tendon comes, and what it costs.

Strokes are read at shares of the current's rise, and work is divided by the rise, so that neither
friction nor the efficiency of the gear scales them.  Two obvious numbers are no features: the work
of the whole wrap, and current over displacement against that of free motion.  In simulation they
move by 0.5 and 1.8 of their range when rotor damping trebles, the strokes by 0.02.
"""

import numpy as np

from spirob.perceive.wrap import Wrap, feature


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
    """Wound-in length between a tenth and three quarters of the rise; little at a stiff one."""
    return wrap.stroke_at(0.75) - wrap.stroke_at(0.1)


@feature("m")
def contact_work(wrap: Wrap) -> float:
    """Work ∫(i - i_free) dx from free motion to the end, over the current's rise."""
    part = slice(wrap.free.start, None)
    return float(np.trapezoid(wrap.share[part], wrap.delayed[part]))


@feature("1/m")
def rise_slope(wrap: Wrap) -> float:
    """Slope di/dx from a tenth to half of the rise over the whole rise, by least squares."""
    first, last = int(wrap.when(0.1)), int(wrap.when(0.5)) + 2
    share, stroke = wrap.share[first:last], wrap.delayed[first:last]
    # dx over di and not its inverse: a wrap that tightens without moving has no di/dx.
    softness = float(np.polyfit(share, stroke, 1)[0])
    return 1.0 / max(softness, 1e-4)


@feature("1/m")
def current_over_stroke(wrap: Wrap) -> float:
    """Share of the current's rise over displacement, mean of the upper half of the rise."""
    first, last = int(wrap.when(0.5)) + 1, int(wrap.when(0.9)) + 2
    return float(np.mean(wrap.share[first:last] / wrap.delayed[first:last]))


@feature("1")
def relative_rise(wrap: Wrap) -> float:
    """Wound-in length from a tenth of the rise to the end, over the whole end stroke."""
    return 1.0 - wrap.stroke_at(0.1) / wrap.end_stroke
