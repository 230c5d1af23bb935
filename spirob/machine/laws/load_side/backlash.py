"""Play between the motor and its load, seen from the load."""

import math

from spirob.effects.effect import Effect
from spirob.machine.laws.backlash import Backlash as AtMotor
from spirob.parameter import bounded


class Backlash(Effect):
    """q_load = q_motor - (b/2)·tanh(τ/τ_0): the motor crosses the play where the load turns round.

    How it runs through the gap is not in the load's motion; over loads of τ_0 to both sides the
    crossing is spread.
    """

    port = "sensing.displacement"
    reads = {"load": "motor.load_torque"}
    neutral = {"play": 0.0}
    equation = "upstream - b/2*tanh(load/t)"
    title = AtMotor.title
    signature = AtMotor.signature
    explanation = AtMotor.explanation
    tell_apart = AtMotor.tell_apart
    needs = AtMotor.needs
    references = AtMotor.references

    play: float = bounded(1e-3, 0.0, 0.02, "m", "b", "way from flank to flank")
    turn: float = bounded(
        4e-3, 4e-4, 4e-2, "N·m", "t", "load over which the flanks change", log=True
    )
    rotor_share: float = bounded(
        0.3, 0.0, 1.0, "1", "μ", "share of the inertia that moves with the motor"
    )

    @staticmethod
    def kernel(upstream, load, play, turn, rotor_share):
        """Position of the load where that of the motor is `upstream`."""
        return upstream - 0.5 * play * math.tanh(load / turn)
