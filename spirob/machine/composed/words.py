"""A composed law in words: what shape it has."""

from typing import Protocol

from spirob.machine.composed.law import Law, Part
from spirob.machine.composed.memory import MEMORIES


class Units(Protocol):
    """What the quantities of a machine are given in."""

    @property
    def torque_unit(self) -> str:
        """Of the law itself."""

    def unit(self, unit: str) -> str:
        """For what is `unit` of a rotor whose place is in m."""


PHRASES = {  # kind of a shape -> what is said of it
    "way": "against the motion",
    "line": "in proportion to speed",
    "share": "in proportion to speed, the same way in both directions",
    "drag": "that grows with the square of speed",
    "lift": "with the square of speed, the same way in both directions",
    "power": "that grows with the power {p} of speed",
    "fading": "that fades beyond {f} in speed",
    "settling": "that levels off beyond {s} in speed",
    "even power": "with the power {p} of speed, the same way in both directions",
    "even fading": "that fades beyond {f} in speed, the same way in both directions",
    "even settling": "that levels off beyond {s} in speed, the same way in both directions",
    "steady": "the same everywhere",
    "far": "in proportion to the place",
    "far2": "with the square of the place",
    "far3": "with the cube of the place",
    "cubic": "of a spring of third order over the way",
    "spot": "in a spot at {c}, half width {w}",
    "turning spot": "in a spot of the turn at {c}, half width {w}",
    "wave": "in waves that come round every {L}",
    "late": "that changes with time",
    "late2": "with the square of time",
    "tide": "that comes and goes every {T}",
    "decay": "that decays in {d}",
    "weight": "in proportion to the load's size",
    "pull": "in proportion to the load",
    "hard": "with the cube of the load",
    "bristle": "that turns round over {r}",
    "spring": "of a spring that yields over {r}",
    "slow direction": "that follows the direction in {e}",
    "slow speed": "that follows the speed in {e}",
    "slow load": "that follows the load in {e}",
    "slow heat": "that follows the square of the load in {e}",
    "slow place": "that follows the place in {e}",
}
CURVE = "in a curve over the way"

FORMULAS = {  # of place x, speed v, load T and time t; v_0 is the speed of rest
    "way": "tanh(v/v_0)",
    "line": "v/v_max",
    "share": "|v|/v_max",
    "drag": "sign(v)·(v/v_max)²",
    "lift": "(v/v_max)²",
    "power": "sign(v)·|v/v_max|^{p}",
    "fading": "sign(v)·exp(-(v/{f})²)",
    "settling": "v/(|v| + {s})",
    "even power": "|v/v_max|^{p}",
    "even fading": "exp(-(v/{f})²)",
    "even settling": "|v|/(|v| + {s})",
    "steady": "",
    "far": "ξ",
    "far2": "ξ²",
    "far3": "ξ³",
    "cubic": "(ξ, ξ², ξ³)",
    "spot": "exp(-½((x - {c})/{w})²)",
    "turning spot": "exp(-½(2·sin((x - {c})/2)/{w})²)",
    "wave": "cos(2π·x/{L} - {a})",
    "late": "t/t_max",
    "late2": "(t/t_max)²",
    "tide": "cos(2π·t/{T} - {b})",
    "decay": "exp(-t/{d})",
    "weight": "|T|/T_max",
    "pull": "T/T_max",
    "hard": "(T/T_max)³",
    "bristle": "z",
    "spring": "z",
    "slow direction": "low-pass(sign(v), {e} s)",
    "slow speed": "low-pass(|v|/v_max, {e} s)",
    "slow load": "low-pass(T/T_max, {e} s)",
    "slow heat": "low-pass((T/T_max)², {e} s)",
    "slow place": "low-pass(ξ, {e} s)",
}


def told(law: Law, sizes: Units) -> str:
    """The shape of the whole law, without a full stop."""
    noun = "friction" if law.brakes else "effort"
    return f"{noun} " + ", and ".join(_phrase(part, sizes) for part in law.parts)


def _phrase(part: Part, sizes: Units) -> str:
    shown = {key: _shown(key, value, sizes) for key, value in part.numbers.items()}
    phrases = [PHRASES.get(kind, CURVE) for kind in part.term.kinds]
    if part.term.memory is not None and part.term.memory.kind not in MEMORIES:
        phrases += [PHRASES["bristle"]] if part.term.memory.memory == "bristle" else []
    return " ".join(phrase.format(**shown) for phrase in phrases)


def _shown(key: str, value: float, sizes: Units) -> str:
    if key == "p":
        return f"{value:.2g}"
    units = {"c": "m", "w": "m", "L": "m", "f": "rad/s", "s": "rad/s", "r": "rad"}
    unit = sizes.unit(units[key]) if key in units else "s"
    return f"{value:.3g} {unit}"


def formula(law: Law, sizes: Units) -> str:
    """The law as a reader writes it, with its numbers."""
    terms = []
    for part in law.parts:
        shown = {key: f"{value:.3g}" for key, value in part.numbers.items()}
        shapes = [FORMULAS.get(kind, "curve(x)").format(**shown) for kind in part.term.kinds]
        product = "·".join(shape for shape in shapes if shape)
        size = f"{part.amplitude:.3g} {sizes.torque_unit}"
        terms.append(f"{size}·{product}" if product else size)
    return f"τ = -({' + '.join(terms)})"
