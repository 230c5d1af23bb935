"""What differs between two motors of one machine.

A friction level is much the same in two motors of one make.  A number that may have either sign,
the phase of a ripple or the offset of a sensor, is an accident of the single motor: a machine with
two of them gets such a number twice, as mean and half difference (left minus right).
"""

from spirob.effects.effect import Effect
from spirob.parameter import Parameter
from spirob.ports import PORTS

SUFFIX = "_difference"


def differences(effect: type[Effect]) -> dict[str, Parameter]:
    """Half differences of the amplitudes of either sign, by field name; neutral at zero."""
    if PORTS[effect.port].each != "motor":
        return {}
    found = {}
    for field, neutral in effect.neutral.items():
        about = effect.parameters()[field]
        if about.low < neutral < about.high:
            reach = min(neutral - about.low, about.high - neutral)
            found[field + SUFFIX] = Parameter(
                0.0,
                -reach,
                reach,
                about.unit,
                f"Δ{about.symbol}",
                f"half of left minus right: {about.meaning}",
            )
    return found
