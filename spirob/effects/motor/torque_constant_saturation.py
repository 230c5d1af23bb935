"""The motor's iron saturates: an ampere more gives less torque."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class TorqueConstantSaturation(Effect):
    """τ → τ/√(1 + s·i²): linear for small currents, level at 1/√s of them, never falling.

    At most s·i² = 1 at the usual current: an ampere more gives a third of the first one's torque
    there, and nobody runs a motor beyond.
    """

    port = "motor.drive_torque"
    reads = {"current": "motor.current"}
    neutral = {"saturation": 0.0}
    equation = "upstream/sqrt(1 + s*current**2)"
    title = "saturation of the torque constant"
    signature = "Current grows faster than the load at high current, in both directions alike."
    explanation = "Near full flux the stator's iron carries no more: torque per ampere falls."
    tell_apart = {
        "stiffness_hardening": "a known weight: saturation follows the current, not the bend",
        "winding_heating": "the same load cold and after minutes: saturation does not wait",
        "load_dependent_friction": "both directions of motion: saturation flips no sign",
    }
    needs = "currents up to the rated one"
    references = ("Hendershot, Miller, Design of Brushless Permanent-Magnet Machines (2010)",)

    saturation: float = bounded(0.005, 0.0, 1.0, "1/A²", "s", "loss of torque per current squared")

    @staticmethod
    def kernel(upstream, current, saturation):
        """Torque of the motor at the rotor [N·m]."""
        return upstream / math.sqrt(1.0 + saturation * current * current)
