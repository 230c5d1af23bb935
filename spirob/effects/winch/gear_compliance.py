"""The gear winds up under load."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class GearCompliance(Effect):
    """k → k/(1 + c_g·k), in other words 1/k → 1/k + c_g: gear and tendon in series.

    c_g = r²/K for a torsional stiffness K at the drum.  One rig cannot tell it from a softer
    tendon, `tendon.stiffness`: fit one of the two.
    """

    port = "tendon.stiffness"
    neutral = {"compliance": 0.0}
    equation = "upstream/(1 + c_g*upstream)"
    title = "torsional compliance of the gear"
    signature = "Length that comes and goes in proportion to the load, the same way back."
    explanation = "Shafts and teeth twist under load, so the drum stays behind the motor."
    tell_apart = {
        "stretch": "small and large loads: the gear's twist stays in proportion",
        "creep": "holds: the gear's twist does not grow with time",
        "drum_build_up": "two loads at the same length: build-up is the same at both",
    }
    needs = "the length channel at two loads"
    references = ("Spong, ASME J. Dynamic Systems 109 (1987)",)

    compliance: float = bounded(2.5e-5, 0.0, 1e-3, "m/N", "c_g", "twist at the drum per tension")

    @staticmethod
    def kernel(upstream, compliance):
        """Stiffness of tendon and gear, tension per stretch [N/m]."""
        return upstream / (1.0 + compliance * upstream)
