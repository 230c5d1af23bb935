"""The gear winds up under load."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded


class GearCompliance(Effect):
    """1/k → 1/k + c_g: the gear's torsional compliance, seen at the drum's surface.

    c_g = r²/K for a torsional stiffness K at the drum.  One rig cannot tell it from a softer
    tendon, `tendon.stiffness`: fit one of the two.
    """

    port = "tendon.compliance"
    neutral = {"compliance": 0.0}
    traits = {"constant"}
    equation = "c_g"
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
    def kernel(compliance):
        """Compliance in series with the tendon [m/N]."""
        return compliance
