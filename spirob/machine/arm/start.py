"""Where the search on an arm's logs begins: numbers that fit the slow part of the currents.

A drum that is moved as it was measured does not give way, so the other motor's rotor swings on both
tendons with hardly a loss, at some hertz.  A model whose swing is off by half a period in a trial
is no better for coming closer, and a fit from the data sheet may end in one of such valleys (2 % of
the current left for 0.25).  What is slower than the swing has none of them.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from spirob.diagnose.rungs import Settings
from spirob.identify.fit import STEPS, fit
from spirob.identify.near import near
from spirob.identify.residual import Residual
from spirob.plant import Rig

BELOW = 0.5  # of the swing's frequency


def slow_start(
    residual: Residual, names: Sequence[str], start: Mapping[str, float], settings: Settings
) -> dict[str, float]:
    """The numbers of `start`, and those of `names` as the slow part of the currents asks for."""
    cutoff = BELOW * swing(residual.plant.rig)
    if cutoff >= residual.filter.cutoff:
        return dict(start)
    slow = near(replace(residual, filter=replace(residual.filter, cutoff=cutoff)), start)
    scale, sets = settings.scale, settings.patience
    return fit(slow, names, start, scale, sets, steps=STEPS[:1], exact=False).changes


def swing(rig: Rig) -> float:
    """Frequency of a rotor on both tendons, the other drum being held [Hz], with nominal numbers.

    Where the arm gives way a tendon that is paid out goes on in the other: two springs in series.
    """
    winch = rig.winch
    mass = rig.motor.rotor_inertia * (winch.gear_ratio / winch.radius) ** 2
    return math.sqrt(0.5 * rig.tendon.stiffness / mass) / (2.0 * math.pi)
