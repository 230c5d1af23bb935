"""The drive's current sensor reads in wrong amperes."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class CurrentGain(Effect):
    """i_measured = (1 + g)·i.

    A drive regulates what its sensor reads: the reading follows the command, the current does not.
    Where effort is known only as current, one rig cannot tell it from the efficiency or the torque
    constant: fit one of them.
    """

    port = "sensing.current"
    neutral = {"gain_error": 0.0}
    equation = "upstream*(1 + g)"
    title = "gain error of the current sensor"
    signature = "Every load takes a current larger or smaller by one share, at rest and in motion."
    explanation = "The shunt or the amplifier of the current sensor is off its rating."
    tell_apart = {
        "current_offset": "two loads: a gain grows with the load",
        "driver_dead_band": "current against command: a gain leaves them alike",
        "torque_constant_saturation": "small and large currents: a gain is the same share of both",
    }
    stands_for = ("winch.efficiency", "motor.torque_constant")
    needs = "a second sensor in the same wire"
    references = ("Ziegler, Woodward, Iu, Borle, IEEE Sensors Journal 9 (2009)",)

    gain_error: float = bounded(0.05, -0.5, 0.5, "1", "g", "relative error of the reading")

    @staticmethod
    def kernel(upstream, gain_error):
        """Measured current [A]."""
        return upstream * (1.0 + gain_error)
