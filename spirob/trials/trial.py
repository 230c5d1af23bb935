"""One trial: what is asked of each motor, for how long, in which scene, and what it is for.

The trial that wraps: one tendon winds the arm round a cylinder that stands beside it.  The left
motor winds in at constant speed until its command stays at the limit, the right one is unactuated
(0 A): it is dragged along, and its gear makes it overrun once the arm stops.  The cylinder stands
on the left of the straight arm, at `position` of its length.  Between 0.655 and 0.68 the tendon's
end stroke falls by at least 0.25 mm for each mm of diameter over 10..70 mm, and every size is
enveloped by 150° or more; at 0.62 strokes of 20 and 25 mm are the same, because the tip finds
another place; below 0.6 the largest are not enveloped.
"""

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields
from typing import Any

import numpy as np

from spirob.control import MODES, Schedule
from spirob.errors import ConfigError
from spirob.geometry import PUBLISHED, SpiralArm
from spirob.robot import CYCLE_NS, MOTORS, Scene, scene_from
from spirob.trials.profiles import PROFILES, Profile
from spirob.unit_table import Geometry

ROLES = ("train", "validate", "heldout")
LONGEST = 24 * 3600.0  # seconds
DRIVE_LIMIT = 20.0  # amperes, full scale of the command frame
TRIAL_KEYS = ("name", "role", "duration", "motors", "scene")
MOTOR_KEYS = ("mode", "profile", "current_limit")
SLOWEST = 1e-3  # m/s


@dataclass(frozen=True)
class MotorPlan:
    """What is asked of one motor: feedback mode, profile in its unit, limit on the command [A]."""

    mode: str
    profile: Profile
    current_limit: float


@dataclass(frozen=True)
class Trial:
    """A trial as declared.

    name      also the name of its log
    role      'train' to fit, 'validate' to decide, 'heldout' only to report
    duration  [s]
    motors    motor -> MotorPlan
    scene     what surrounds the arm
    plain     the same as plain data, for logs
    """

    name: str
    role: str
    duration: float
    motors: Mapping[str, MotorPlan]
    scene: Scene = field(default_factory=Scene)
    plain: Mapping[str, Any] = field(default_factory=dict, compare=False, repr=False)

    @classmethod
    def from_plain(cls, given: Any) -> "Trial":
        """A trial from plain data, as a configuration file has it.

        Raises ConfigError naming the trial and the key.
        """
        name = given.get("name") if isinstance(given, Mapping) else None
        if not isinstance(name, str) or not name or set(name) & set("/\\\0") or name[0] == ".":
            raise ConfigError(f"a trial needs a 'name' that can name a file, not {name!r}")
        where = f"trial '{name}'"
        _require_keys(given, where, TRIAL_KEYS, optional=("scene",))
        if given["role"] not in ROLES:
            raise ConfigError(f"{where}: role must be {' or '.join(ROLES)}, not {given['role']!r}")
        duration = _positive(given["duration"], f"{where}: duration", LONGEST)
        if duration * 1e9 < CYCLE_NS:
            raise ConfigError(f"{where}: duration {duration} s is shorter than one cycle")
        _require_keys(given["motors"], f"{where}: motors", MOTORS)
        motors = {m: _plan(given["motors"][m], f"{where}: motors.{m}") for m in MOTORS}
        scene = scene_from(given.get("scene"), where)
        return cls(name, given["role"], duration, motors, scene, _plain(given))

    @property
    def cycles(self) -> int:
        """Length in cycles of 1 ms."""
        return round(self.duration * 1e9 / CYCLE_NS)

    def schedule(self, cycles: int | None = None) -> Schedule:
        """The references of every cycle, for `cycles` or the whole trial."""
        t = np.arange(self.cycles if cycles is None else cycles) * (CYCLE_NS / 1e9)
        plans = [self.motors[motor] for motor in MOTORS]
        followed = [plan.profile(t) for plan in plans]
        moves = [plan.mode == "displacement" for plan in plans]
        return Schedule(
            mode=np.array([MODES[plan.mode] for plan in plans]),
            reference=np.column_stack([value for value, _ in followed]),
            reference_rate=np.column_stack(
                [
                    rate if move else np.zeros_like(rate)
                    for (_, rate), move in zip(followed, moves, strict=True)
                ]
            ),
            current_limit=np.array([plan.current_limit for plan in plans]),
        )


def _plan(given: Any, where: str) -> MotorPlan:
    _require_keys(given, where, MOTOR_KEYS)
    mode = given["mode"]
    if mode not in MODES:
        raise ConfigError(f"{where}.mode '{mode}' is unknown; known: {', '.join(MODES)}")
    limit = _positive(given["current_limit"], f"{where}.current_limit", DRIVE_LIMIT)
    return MotorPlan(mode, profile_from(given["profile"], mode, f"{where}.profile"), limit)


def _require_keys(
    given: Any, where: str, keys: tuple[str, ...], optional: tuple[str, ...] = ()
) -> None:
    if not isinstance(given, Mapping):
        raise ConfigError(f"{where} must be a mapping with {', '.join(keys)}, not {given!r}")
    for key in given:
        if key not in keys:
            raise ConfigError(f"{where} has no key '{key}'; it has: {', '.join(keys)}")
    for key in keys:
        if key not in given and key not in optional:
            raise ConfigError(f"{where} needs '{key}'")


def _positive(value: Any, where: str, high: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value <= high:
        raise ConfigError(f"{where} must be a number above 0 and at most {high:g}, not {value!r}")
    return float(value)


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value


def profile_from(given: Any, mode: str, where: str) -> Profile:
    """A profile from plain data `{kind: sine, amplitude: 0.02, ...}`.

    Raises ConfigError; `where` names the trial and the key.
    """
    if not isinstance(given, Mapping) or "kind" not in given:
        raise ConfigError(f"{where} must be a mapping with the key 'kind', not {given!r}")
    if given["kind"] not in PROFILES:
        known = ", ".join(PROFILES)
        raise ConfigError(f"{where}.kind '{given['kind']}' is unknown; known: {known}")
    chosen = PROFILES[given["kind"]]
    if mode not in chosen.modes:
        modes = ", ".join(chosen.modes)
        raise ConfigError(f"{where}: '{given['kind']}' is for mode {modes}, not '{mode}'")
    known_keys = {about.name: about for about in fields(chosen)}
    for key in given:
        if key != "kind" and key not in known_keys:
            listed = ", ".join(known_keys)
            raise ConfigError(f"{where} has no key '{key}'; {given['kind']} has: {listed}")
    for key, about in known_keys.items():
        if about.default is MISSING and key not in given:
            raise ConfigError(f"{where} needs '{key}' for {given['kind']}")
    try:
        profile = chosen(**{key: value for key, value in given.items() if key != "kind"})
        profile(np.zeros(1))
    except ValueError as error:
        raise ConfigError(f"{where}: {error}") from error
    return profile


@dataclass(frozen=True, kw_only=True)
class WrapSettings:
    """What all wraps of one campaign have in common; the variations are half widths, uniform.

    position            of the cylinder along the straight arm, as a share of its length [-]
    gap                 between cylinder and straight arm [m]; never below 0
    speed               at which the left tendon is wound in [m/s];  blend  its start-up [s]
    current_limit       of both commands [A];  duration [s]
    friction            of the cylinder's surface [-]
    placement           variation of the centre along and across the arm [m]
    speed_variation     relative [-];  friction_variation  absolute [-]
    rest                longest wait before the winding begins [s]
    blend_variation     of the start-up, relative [-]
    """

    position: float = 0.67
    gap: float = 0.003
    speed: float = 0.045
    blend: float = 0.2
    current_limit: float = 2.0
    duration: float = 4.5
    friction: float = 0.3
    placement: float = 0.002
    speed_variation: float = 0.05
    friction_variation: float = 0.1
    rest: float = 0.0
    blend_variation: float = 0.0

    def __post_init__(self) -> None:
        ranges = {
            "position": (0.1, 0.95),
            "gap": (0.0, 0.2),
            "speed": (SLOWEST, 1.0),
            "blend": (0.0, 5.0),
            "current_limit": (0.01, 20.0),
            "duration": (0.1, 600.0),
            "friction": (0.0, 2.0),
            "placement": (0.0, self.gap),
            "speed_variation": (0.0, 0.5),
            "friction_variation": (0.0, self.friction),
            "rest": (0.0, 60.0),
            "blend_variation": (0.0, 0.9),
        }
        for key, (low, high) in ranges.items():
            value = getattr(self, key)
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise ConfigError(f"wrap: {key} must be a number, not {value!r}")
            if not low <= value <= high:
                raise ConfigError(f"wrap: {key} = {value} is out of range [{low:g}, {high:g}]")

    @classmethod
    def from_mapping(cls, given: Mapping[str, Any]) -> "WrapSettings":
        """Settings from a configuration; raises ConfigError on an unknown key or a bad value."""
        known = [about.name for about in fields(cls)]
        for key in given:
            if key not in known:
                raise ConfigError(f"wrap has no setting '{key}'; it has: {', '.join(known)}")
        return cls(**given)


def wrap_trial(
    name: str,
    role: str,
    diameter: float,
    settings: WrapSettings | Mapping[str, Any],
    rng: np.random.Generator,
    geometry: Geometry = PUBLISHED,
) -> dict[str, Any]:
    """A wrap round a cylinder of `diameter` [m] as plain data for `Trial.from_plain`.

    geometry  of the arm beside which the cylinder stands

    rng  draws placement, speed and friction; always four numbers, so that the n-th trial of a
         campaign does not depend on which variations are switched on.  The start is drawn from a
         child of it, which takes none of its numbers.  A rest prolongs the trial by itself.
    Raises ConfigError on bad settings or a diameter that is not above 0.
    """
    if not isinstance(settings, WrapSettings):
        settings = WrapSettings.from_mapping(settings)
    if not (np.isfinite(diameter) and diameter > 0):
        raise ConfigError(f"trial '{name}': a cylinder's diameter must be above 0, not {diameter}")
    along, across, faster, rougher = rng.uniform(-1.0, 1.0, 4).tolist()
    x = settings.position * geometry.length + settings.placement * along
    y = beside(geometry.arm(), x, diameter / 2 + settings.gap) + settings.placement * across
    speed = settings.speed * (1 + settings.speed_variation * faster)
    winding, rest = _start(speed, settings, rng)
    return {
        "name": name,
        "role": role,
        "duration": float(settings.duration) + rest,
        "motors": {
            "left": _motor("velocity", winding, settings),
            "right": _motor("current", {"kind": "constant", "value": 0.0}, settings),
        },
        "scene": {
            "cylinder": {
                "diameter": float(diameter),
                "x": float(x),
                "y": float(y),
                "friction": float(settings.friction + settings.friction_variation * rougher),
            }
        },
    }


def _start(
    speed: float, settings: WrapSettings, rng: np.random.Generator
) -> tuple[dict[str, Any], float]:
    """Profile of the winding, and how long it rests before [s], whole cycles."""
    waits, softer = rng.spawn(1)[0].uniform((0.0, -1.0), 1.0).tolist()
    rest = round(settings.rest * waits, 3)
    blend = float(settings.blend * (1 + settings.blend_variation * softer))
    if rest == 0.0:
        return {"kind": "constant", "value": float(speed), "blend": blend}, 0.0
    return {"kind": "steps", "plateaus": [[rest, 0.0], [1.0, float(speed)]], "blend": blend}, rest


def beside(arm: SpiralArm, x: float, distance: float) -> float:
    """y [m] of the point above `x` that is `distance` [m] away from the straight arm's left edge.

    The edge is taken as the line through the units' middles: it falls by 5° towards the tip, and
    the distance counts across it.
    """
    middle = arm.hinge_position + arm.unit_length / 2
    slope, edge = np.polyfit(middle, arm.half_width, 1)
    return float(edge + slope * x + distance * np.hypot(1.0, slope))


def _motor(mode: str, profile: dict[str, Any], settings: WrapSettings) -> dict[str, Any]:
    return {"mode": mode, "profile": profile, "current_limit": float(settings.current_limit)}
