"""Drag that grows with the square of speed."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class QuadraticDrag(Effect):
    """τ = -c·ω·|ω| at the rotor."""

    port = "motor.torque"
    reads = {"speed": "motor.speed"}
    neutral = {"drag": 0.0}
    traits = {"dissipative", "odd_in_speed"}
    equation = "-c*speed*Abs(speed)"
    title = "quadratic drag"
    signature = "Effort odd in speed that grows with its square: only the fast parts show it."
    explanation = "A fan, churned grease or air resists with the square of the shaft's speed."
    tell_apart = {
        "coulomb_friction": "two speeds a factor of three apart: only drag grows",
        "asymmetric_viscous_friction": "the same speed both ways: drag is the same in both",
    }
    needs = "speeds that span a factor of three"
    references = ("White, Fluid Mechanics: flow past bodies",)

    drag: float = bounded(5e-7, 0.0, 1e-4, "N·m·s²/rad²", "c", "coefficient of speed squared")

    @staticmethod
    def kernel(speed, drag):
        """Drag torque on the rotor [N·m]."""
        return -drag * speed * abs(speed)
