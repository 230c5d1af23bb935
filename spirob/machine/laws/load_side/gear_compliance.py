"""A shaft or gear that winds up, seen from its load."""

from spirob.effects.effect import Effect
from spirob.machine.laws.gear_compliance import GearCompliance as AtMotor
from spirob.parameter import bounded


class GearCompliance(Effect):
    """q_load = q_motor - c·τ: a sensor at the load trails the motor by the twist under its load.

    Valid well below the frequency at which the load swings on the spring, where the twist follows
    the load without delay.
    τ holds the torque of all that moves, the motor's share μ of the inertia included: on an axis of
    inertia alone, c is the shaft's own compliance times 1 - μ.
    """

    port = "sensing.displacement"
    reads = {"load": "motor.load_torque"}
    neutral = {"compliance": 0.0}
    equation = "upstream - c*load"
    title = AtMotor.title
    signature = "Effort that the load's motion asks for too late, more so the faster it changes."
    explanation = AtMotor.explanation
    tell_apart = AtMotor.tell_apart
    needs = AtMotor.needs
    references = AtMotor.references

    compliance: float = bounded(0.025, 0.0, 1.5, "m/(N·m)", "c", "twist for one unit of load")
    rotor_share: float = bounded(
        0.3, 0.0, 1.0, "1", "μ", "share of the inertia that moves with the motor"
    )

    @staticmethod
    def kernel(upstream, load, compliance, rotor_share):
        """Position of the load where that of the motor is `upstream`."""
        return upstream - compliance * load
