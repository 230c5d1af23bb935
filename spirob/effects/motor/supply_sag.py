"""The supply's voltage falls under load."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class SupplySag(Effect):
    """U → U - R_s·P/U: the supply's inner resistance times the current that the motor draws.

    P is the motor's electrical power; what it feeds back does not raise the voltage.  A tenth of
    the voltage always remains.
    """

    port = "motor.supply"
    reads = {"power": "motor.power"}
    neutral = {"supply_resistance": 0.0}
    equation = "Max(upstream - R_s*Max(power, 0)/upstream, upstream/10)"
    title = "sag of the supply voltage"
    signature = "Speed and current fall short of their command at high power, and only there."
    explanation = (
        "Cables, connectors and the source itself have a resistance: at high power the drive has "
        "less voltage left to push the current."
    )
    tell_apart = {
        "driver_dead_band": "high power: a dead band shows at small currents",
        "winding_heating": "the same power cold and warm: sag does not wait",
    }
    needs = "the drive at its voltage limit: high speed under load"
    references = ("Mohan, Undeland, Robbins, Power Electronics (2003)",)

    supply_resistance: float = bounded(0.2, 0.0, 5.0, "Ω", "R_s", "resistance of the supply")

    @staticmethod
    def kernel(upstream, power, supply_resistance):
        """Voltage that the drive can put out [V]."""
        drawn = max(power, 0.0) / upstream
        return max(upstream - supply_resistance * drawn, upstream / 10.0)
