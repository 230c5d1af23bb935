"""One trial: what is asked of each motor, for how long, in which scene, and what it is for."""

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields
from typing import Any

import numpy as np

from spirob.control import MODES, Schedule
from spirob.errors import ConfigError
from spirob.robot import CYCLE_NS, MOTORS, Scene, scene_from
from spirob.trials.profiles import PROFILES, Profile

ROLES = ("train", "validate", "heldout")
LONGEST = 24 * 3600.0  # seconds
DRIVE_LIMIT = 20.0  # amperes, full scale of the command frame
TRIAL_KEYS = ("name", "role", "duration", "motors", "scene")
MOTOR_KEYS = ("mode", "profile", "current_limit")


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
