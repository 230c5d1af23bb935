"""What an arm is: the logarithmic-spiral law of its drawing, lengths and angles, no physics.

The spiral r(θ) = a·exp(bθ) is cut every Δθ into units that are similar to each other: each is the
one before it scaled by γ⁻¹ = exp(-bΔθ) towards the tip.  Straightened, the units lie along +x
from the base (unit 1) to the tip (unit N); hinge i is where unit i meets the one before it, and
its axis is +z.  Neighbouring faces are slanted by Δθ/2 each, so that they touch when the hinge has
turned by Δθ.  A tendon runs through the faces at a height that falls linearly from base to tip.

Sources: Wang, Freris, Wei, "SpiRobs", Device 2024; the default design of the published design
tool (length 464.08 mm, base 83.70 mm, tip 10.00 mm for 24 units of 30°).
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Any

import numpy as np

from spirob.errors import ConfigError

SPIRAL_GROWTH = 0.1764  # b, 1/rad; default of the published design tool
SPIRAL_TURN = 4 * np.pi  # rad; 24 units of 30 degrees
ARM_LENGTH = 0.46408  # m; published length of the discretised default design
BASE_WIDTH = 0.083704  # m; published width of the base unit
GUIDE_HEIGHT_BASE = 0.9  # tendon height over half width at the base
GUIDE_HEIGHT_TIP = 0.5  # the same at the tip
UNITS = (2, 200)  # that an arm may have
LEAST_GROWTH = 1e-3  # from which `a` says how wide an arm is
ALIKE = 1e-12  # relative: ratios of neighbouring units that differ by less are one ratio


@dataclass(frozen=True)
class SpiralArm:
    """Lengths of an arm cut into units; arrays run from base to tip.

    unit_angle      angle between the two faces of each unit [rad] (N,), Δθ on a drawing
    scale           size of each unit relative to the base unit, (N,), scale[0] = 1
    unit_length     [m] (N,), their sum is the arm's length
    hinge_position  x of each hinge in the straight arm [m] (N,), hinge_position[0] = 0
    half_width      [m] (N,), half the width of each unit at its middle
    guide_before    (N, 2) tendon guide on the face before each hinge (on the unit nearer the
                    base, or on the mount for hinge 1), as (x, y) relative to the hinge [m], for
                    the tendon on the +y side; the other tendon is its mirror image
    guide_after     (N, 2) the same on the face after the hinge
    """

    unit_angle: np.ndarray
    scale: np.ndarray
    unit_length: np.ndarray
    hinge_position: np.ndarray
    half_width: np.ndarray
    guide_before: np.ndarray
    guide_after: np.ndarray

    @property
    def units(self) -> int:
        """Number of units, which is also the number of hinges."""
        return len(self.unit_length)

    @property
    def length(self) -> float:
        """Of the straight arm [m]."""
        return float(self.unit_length.sum())

    @property
    def hinge_angle(self) -> np.ndarray:
        """Turn at which the faces of each hinge touch [rad] (N,); the mount's is as unit 1's."""
        before = np.append(self.unit_angle[0], self.unit_angle[:-1])
        return np.asarray((before + self.unit_angle) / 2)

    @property
    def taper(self) -> np.ndarray:
        """Size of each unit over that of the next one, (N,); of the last as of the one before."""
        ratio = self.scale[:-1] / self.scale[1:]
        ratio = np.where(np.abs(ratio - ratio[0]) < ALIKE, ratio[0], ratio)
        return np.append(ratio, ratio[-1])


@dataclass(frozen=True)
class Drawing:
    """The numbers of a design; those of the published one where nothing is said.

    units       of the drawing, each turning by turn/units
    growth      b of the spiral;  turn  units·Δθ [rad]
    length      of the straight arm [m]
    base_width  of unit 1 at its middle [m]
    hole_base, hole_tip  height of the tendon over half the width, where the arm begins and ends
    mount       how far the mount's hole lies behind the mount's face [m]

    Raises ConfigError, naming the key, for an arm that cannot be.
    """

    units: int = 24
    growth: float = SPIRAL_GROWTH
    turn: float = SPIRAL_TURN
    length: float = ARM_LENGTH
    base_width: float = BASE_WIDTH
    hole_base: float = GUIDE_HEIGHT_BASE
    hole_tip: float = GUIDE_HEIGHT_TIP
    mount: float = 0.0

    def __post_init__(self) -> None:
        ranges = {
            "units": UNITS,
            "growth": (0.0, 1.0),
            "length": (0.01, 10.0),
            "base_width": (1e-3, 2.0),
            "hole_base": (0.02, 0.98),
            "hole_tip": (0.02, 0.98),
            "mount": (-0.1, 0.2),
        }
        for name, (low, high) in ranges.items():
            if not low <= getattr(self, name) <= high:
                key = KEYS.get(name, name)
                said = f"{key} = {getattr(self, name):g} is out of range [{low:g}, {high:g}]"
                raise ConfigError(f"geometry: {said}")
        _require_angle(self.turn / self.units)
        self._not_crossing()

    def _not_crossing(self) -> None:
        arm = self.arm()
        inset = arm.half_width[0] * np.tan(arm.unit_angle[0] / 2)
        if 2 * inset >= arm.unit_length[0]:
            raise ConfigError(
                f"geometry: base_width = {self.base_width:g} m: faces slanted by "
                f"{np.rad2deg(arm.unit_angle[0]) / 2:.3g}° cross inside of units that are "
                f"{arm.unit_length[0]:.3g} m long"
            )
        if self.mount <= -(room := -float(arm.guide_before[0, 0]) - self.mount):
            raise ConfigError(
                f"geometry: mount = {self.mount:g} m puts the mount's hole ahead of the first "
                f"hinge, {room:.3g} m before its face"
            )

    @classmethod
    def from_mapping(cls, given: Mapping[str, Any]) -> "Drawing":
        """The drawing from the design tool's numbers; see `docs/geometry.md` for the keys.

        Either `a` says how large the arm is, or `length` and `base_width` do; with none of them it
        is the published arm.  Raises ConfigError naming the key.
        """
        for key in given:
            if key not in DESIGN:
                raise ConfigError(f"geometry has no key '{key}'; it has: {', '.join(DESIGN)}")
        numbers = {key: _number(key, value) for key, value in given.items()}
        if numbers.get("units", 2.0) % 1:
            raise ConfigError(f"geometry: units = {numbers['units']:g} is no whole number")
        units, growth = int(numbers.pop("units", 24)), numbers.pop("b", SPIRAL_GROWTH)
        if not UNITS[0] <= units <= UNITS[1]:
            raise ConfigError(f"geometry: units = {units} is out of range {list(UNITS)}")
        angle = np.deg2rad(numbers.pop("unit_angle_deg", np.rad2deg(SPIRAL_TURN / 24)))
        _require_angle(angle)
        numbers |= _sizes(numbers, units, growth, angle)
        return cls(units=units, growth=growth, turn=units * angle, **numbers)

    def arm(self, units: int | None = None) -> SpiralArm:
        """Its lengths; cut into another number of units over the same total turn and length."""
        return _cut(self, self.units if units is None else units)


KEYS = {"growth": "b", "turn": "unit_angle_deg"}  # of a field, in a mapping
DESIGN = (
    *("a", "b", "unit_angle_deg", "units", "size", "length", "base_width"),
    *("hole_base", "hole_tip", "mount"),
)


def spiral_arm(units: int = 24, size: float = 1.0) -> SpiralArm:
    """Cut the published arm into `units` units over the same total turn and length.

    units  how many hinges; 24 is the published arm, 48 the same arm cut twice as fine
    size   scale of the whole arm; 1 is the 464 mm default design
    """
    return Drawing(length=size * ARM_LENGTH, base_width=size * BASE_WIDTH).arm(units)


def _require_angle(angle: float) -> None:
    if not 1.0 <= (degrees := np.rad2deg(angle)) <= 90.0:
        raise ConfigError(f"geometry: unit_angle_deg = {degrees:g} is out of range [1, 90]")


def _number(key: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise ConfigError(f"geometry: {key}: a number is needed, got {str(value)[:40]!r}")
    return float(value)


def _sizes(numbers: dict[str, float], units: int, b: float, angle: float) -> dict[str, float]:
    """Length and width of the base, from `a` or as given, both times `size`.

    The drawing's outline lies between r and r·exp(2πb), so at θ it is a(exp(2πb) - 1)exp(bθ) wide
    and its axis runs at r_c = a(exp(2πb) + 1)/2·exp(bθ); a unit is a chord of that.  The width of
    a unit is that of its end nearer to the tip.
    """
    size, a = numbers.pop("size", 1.0), numbers.pop("a", None)
    if size <= 0.0:
        raise ConfigError(f"geometry: size = {size:g}; it is above 0")
    given = {key for key in ("length", "base_width") if key in numbers}
    if a is not None and given:
        raise ConfigError(f"geometry: either a or {' and '.join(sorted(given))}")
    if a is None and len(given) == 1:
        raise ConfigError("geometry: length and base_width belong together")
    if a is None:
        length, width = numbers.get("length", ARM_LENGTH), numbers.get("base_width", BASE_WIDTH)
        return {"length": size * length, "base_width": size * width}
    if a <= 0.0 or not LEAST_GROWTH <= b <= 1.0:
        said = f"a = {a:g}, b = {b:g}; a is above 0, and b in [{LEAST_GROWTH:g}, 1] beside it"
        raise ConfigError(f"geometry: {said}")
    turn, step = np.exp(2 * np.pi * b), np.exp(b * angle)
    chord = a * (turn + 1) / 2 * np.sqrt(1 + step**2 - 2 * step * np.cos(angle))
    length = chord * np.expm1(b * angle * units) / np.expm1(b * angle)
    width = a * (turn - 1) * step ** (units - 1)
    return {"length": float(size * length), "base_width": float(size * width)}


@lru_cache(maxsize=64)
def _cut(drawing: Drawing, units: int) -> SpiralArm:
    angle = drawing.turn / units
    scale = np.exp(-drawing.growth * angle * np.arange(units))
    unit_length = drawing.length * scale / scale.sum()
    hinge = np.concatenate([[0.0], np.cumsum(unit_length)[:-1]])
    # the width belongs to the middle of the drawing's first unit
    offset = drawing.growth * (drawing.turn / drawing.units - angle) / 2
    half_width = drawing.base_width / 2 * np.exp(offset) * scale
    before, after = _guides(drawing, hinge, angle)
    arm = SpiralArm(np.full(units, angle), scale, unit_length, hinge, half_width, before, after)
    for about in fields(arm):  # shared by all who ask
        getattr(arm, about.name).flags.writeable = False
    return arm


def _guides(drawing: Drawing, hinge: np.ndarray, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Where the tendon's straight line y(x) = y0 + slope·x meets the two faces of each hinge."""
    share = (drawing.units - 1) / drawing.units
    tip_half_width = drawing.base_width / 2 * np.exp(-drawing.growth * drawing.turn * share)
    base_height = drawing.hole_base * drawing.base_width / 2
    slope = (drawing.hole_tip * tip_half_width - base_height) / drawing.length
    face = np.tan(angle / 2)
    axis_height = base_height + slope * hinge
    y_before = axis_height / (1 + slope * face)
    y_after = axis_height / (1 - slope * face)
    before = np.column_stack([-face * y_before, y_before])
    after = np.column_stack([face * y_after, y_after])
    if drawing.mount:
        before[0] -= drawing.mount * np.array([1.0, slope])
    return before, after


PUBLISHED = Drawing()
