"""The motor warms up, and its magnets weaken."""

import math

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class WindingHeating(Effect):
    """τ → τ/(1 + w), dw/dt = ρ·i² - w/T: the winding's losses warm the magnets.

    w is the temperature's rise times the magnets' loss per kelvin.  The winding's resistance rises
    too; a current-regulated drive hides that.  The update is exact for a constant current.
    """

    port = "motor.drive_torque"
    reads = {"current": "motor.current"}
    state = {"warmth": 0.0}
    free = ("warmth",)
    neutral = {"heating": 0.0}
    equation = "upstream/(1 + warmth)"
    evolution = {"warmth": "ρ*current**2 - warmth/T"}
    title = "warming of the motor"
    signature = "The current for the same load climbs with time, fastest after high currents."
    explanation = (
        "The winding's losses warm the motor; warm magnets give less torque for an ampere, so the "
        "same load takes more and more current."
    )
    tell_apart = {
        "torque_constant_saturation": "the same load cold and after minutes at it: heat takes time",
        "joint_viscoelasticity": "a known weight at rest: heat makes its current climb",
        "creep": "the length channel in a hold: heat changes no length",
    }
    needs = "long or repeated high currents with the same load early and late"
    references = ("Mellor, Roberts, Turner, IEE Proc. B 138 (1991)",)

    heating: float = bounded(5e-3, 0.0, 0.2, "1/(A²·s)", "ρ", "loss of torque per heat put in")
    time: float = bounded(60.0, 2.0, 2000.0, "s", "T", "thermal time constant", log=True)

    @staticmethod
    def kernel(upstream, current, warmth, heating, time, dt):
        """Torque of the motor at the rotor [N·m] and the next warmth [-]."""
        final = heating * time * current * current
        warmth = final + (warmth - final) * math.exp(-dt / time)
        return upstream / (1.0 + warmth), warmth
