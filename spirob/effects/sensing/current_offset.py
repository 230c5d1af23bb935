"""The drive's current sensor does not read zero at zero current."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class CurrentOffset(Effect):
    """i_measured = i + i_0.

    A drive regulates what its sensor reads: the reading follows the command, the current does not.
    """

    port = "sensing.current"
    neutral = {"offset": 0.0}
    traits = {"constant"}
    equation = "upstream + i_0"
    title = "offset of the current sensor"
    signature = "Every load takes a current larger or smaller by as much, at rest and in motion."
    explanation = "The amplifier of the current sensor has a zero error."
    tell_apart = {
        "constant_force": "swap or free the load: an offset stays",
        "rest_curvature": "swap the pulling tendon: an offset is the same, a bend changes sign",
        "current_gain": "two loads: an offset is the same at both",
        "driver_dead_band": "current against command: an offset leaves them alike",
    }
    needs = "rest with the motor off, or both directions of load"
    references = ("Analog Devices, MT-037: input offset voltage",)

    offset: float = bounded(0.02, -1.0, 1.0, "A", "i_0", "reading at zero current")

    @staticmethod
    def kernel(upstream, offset):
        """Measured current [A]."""
        return upstream + offset
