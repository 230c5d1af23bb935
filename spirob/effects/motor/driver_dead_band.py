"""The drive does not answer to small commands."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class DriverDeadBand(Effect):
    """i_cmd → sgn(i_cmd)·max(|i_cmd| - d, 0)."""

    port = "command.current"
    neutral = {"dead_band": 0.0}
    equation = "sign(upstream)*Max(Abs(upstream) - d, 0)"
    title = "dead band of the drive"
    signature = "What is given stays short of its command by the same amount, and zero near zero."
    explanation = (
        "The dead time of the bridge and the driver's threshold swallow the first part of every "
        "command."
    )
    tell_apart = {
        "current_offset": "current against command: a dead band leaves them apart, an offset not",
        "coulomb_friction": "current against command at standstill: friction leaves them equal",
        "current_gain": "current against command: a dead band leaves them apart, a gain not",
    }
    needs = "the commanded current beside the measured one, at small commands"
    references = ("Leggate, Kerkman, IEEE Trans. Industrial Electronics 44 (1997)",)

    dead_band: float = bounded(0.05, 0.0, 1.0, "A", "d", "command that is swallowed")

    @staticmethod
    def kernel(upstream, dead_band):
        """Command as the drive understands it [A]."""
        return math.copysign(max(abs(upstream) - dead_band, 0.0), upstream)
