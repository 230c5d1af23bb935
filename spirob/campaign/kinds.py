"""The answer key: what counts as right for each kind that is hidden.  Only scoring reads this."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Kind:
    """What a kind is called.

    family   of which an axis has one at a time: two of them would be a third
    names    of the library that are right, each by itself; none where it holds no such effect
    besides  names that may stand beside a right one, as the machine is that, too
    near     names that say a part of it: neither right nor wrong
    """

    family: str
    names: frozenset[str] = frozenset()
    besides: frozenset[str] = frozenset()
    near: frozenset[str] = frozenset()


def _kind(family: str, names: str = "", near: str = "") -> Kind:
    return Kind(family, frozenset(names.split()), near=frozenset(near.split()))


DRY = "coulomb_friction stribeck_friction presliding_friction"
LOSS = "load_dependent_friction direction_dependent_efficiency"
CONSTANT = "constant_force current_offset"

KINDS: dict[str, Kind] = {
    "coulomb_friction": _kind("dry", "coulomb_friction", DRY),
    "stribeck_friction": _kind("dry", "stribeck_friction", DRY),
    "presliding_friction": _kind("dry", "presliding_friction", DRY),
    "load_dependent_friction": _kind("loss", LOSS),
    "direction_dependent_efficiency": _kind("loss", LOSS),
    "asymmetric_viscous_friction": _kind("asymmetric", "asymmetric_viscous_friction"),
    "quadratic_drag": _kind("drag", "quadratic_drag"),
    "cogging": _kind("wave", "cogging"),
    "torque_ripple": _kind("wave", "torque_ripple"),
    "tip_payload": _kind("weight", "tip_payload"),
    "constant_force": _kind("constant", CONSTANT),
    "current_offset": _kind("constant", CONSTANT),
    "current_gain": _kind("gain", "current_gain"),
    "current_lag": _kind("late", "current_lag"),
    "feedback_latency": _kind("late", "feedback_latency"),
    "driver_dead_band": _kind("command", "driver_dead_band"),
    "torque_constant_saturation": _kind("iron", "torque_constant_saturation"),
    "winding_heating": _kind("heat", "winding_heating"),
    "gear_compliance": _kind("shaft", "gear_compliance"),
    "backlash": _kind("shaft", "backlash", "gear_compliance"),
    "encoder_eccentricity": _kind("wave", "encoder_eccentricity"),
    # what no effect of the library is
    "position_viscosity": _kind("drag"),
    "drifting_friction": _kind("dry", near=DRY),
    "power_friction": _kind("dry"),
    "progressive_spring": _kind("weight"),
    "tight_spot": _kind("dry", near=DRY),
    "hysteretic_spring": _kind("weight", near="presliding_friction"),
    "chirped_magnets": _kind("wave"),
    "speed_efficiency": _kind("iron"),
    "stick_one_way": _kind("dry", near=DRY),
    "loose_screw": _kind("shaft"),
}
LIBRARY = tuple(name for name, kind in KINDS.items() if kind.names)
OUTSIDE = tuple(name for name, kind in KINDS.items() if not kind.names)
# drawn with the seed: two and three of the library; one of it, and less of one that it lacks
NONE, TWO, THREE, BESIDE = "none", "two", "three", "beside"
DRAWN = {TWO: 2, THREE: 3, BESIDE: 1}  # how many of the library
# sizes of a current's reading, which no description tells from its scale
NO_PARTNER = frozenset({"current_gain", "current_lag", "feedback_latency"})


def answers(kind: str, bristles: bool, one_way: bool) -> Kind:
    """What counts as right for a kind in one machine.

    bristles  its dry friction always turns round over a way: Coulomb friction is presliding, too
    one_way   it moved one way in all logs: dry friction is then a constant force
    """
    known = KINDS[kind]
    names, besides = known.names, known.besides
    if bristles and kind == "coulomb_friction":
        names = names | {"presliding_friction"}
    if bristles and kind == "stribeck_friction":
        besides = besides | {"presliding_friction"}
    if one_way and known.family in ("dry", "constant") and known.names:
        names = names | set(CONSTANT.split()) | {"coulomb_friction", "presliding_friction"}
    return Kind(known.family, names, besides, known.near - names)
