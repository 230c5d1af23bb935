"""What a log says about how its trial was played: for simulating the same again."""

from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import Any

import numpy as np

from spirob.control import Schedule
from spirob.errors import ConfigError, DataError
from spirob.robot import MOTORS, Ball, Cylinder, Peg, Scene, Weights
from spirob.trace import Trace

OBJECTS: dict[str, type] = {
    "cylinder": Cylinder,
    "ball": Ball,
    "peg": Peg,
    "weights": Weights,
}
ABOVE_ZERO = ("diameter", "mass", "radius", "period")
NOT_BELOW_ZERO = ("friction", "left", "right")


def schedule_of(trace: Trace) -> Schedule:
    """Mode, references and limits as they were asked, cycle by cycle.

    Raises DataError where the trial's description lacks a motor's current limit.
    """
    trial: Any = trace.meta.get("trial", {})
    try:
        limits = [float(trial["motors"][motor]["current_limit"]) for motor in MOTORS]
    except (KeyError, TypeError, ValueError) as error:
        raise DataError(f"{trace.name}: its description lacks a current_limit: {error}") from error
    return Schedule(
        mode=np.array([int(trace[f"{motor}.mode"][0]) for motor in MOTORS]),
        reference=np.column_stack([trace[f"{motor}.reference"] for motor in MOTORS]),
        reference_rate=np.column_stack([trace[f"{motor}.reference_rate"] for motor in MOTORS]),
        current_limit=np.array(limits),
    )


def scene_of(trace: Trace) -> Scene:
    """What surrounded the arm; raises ConfigError naming the trial and the key."""
    scene: Any = trace.meta.get("scene") or {}
    return scene_from(scene, f"trial '{trace.name}'")


def scene_from(scene: Mapping[str, Any] | None, where: str) -> Scene:
    """A scene from plain data: nothing, or one of `OBJECTS` as `{cylinder: {diameter: ..., ...}}`.

    Raises ConfigError; `where` names what the scene belongs to.
    """
    scene = _mapping(scene or {}, f"{where}: scene", tuple(OBJECTS))
    present = [kind for kind in OBJECTS if scene.get(kind)]
    if len(present) > 1:
        raise ConfigError(f"{where}: scene holds {' and '.join(present)}, but may hold only one")
    return Scene(**{kind: _object(scene[kind], f"{where}: scene.{kind}", kind) for kind in present})


def _object(given: Any, where: str, kind: str) -> Any:
    about = fields(OBJECTS[kind])
    given = _mapping(given, where, tuple(f.name for f in about))
    values: dict[str, float] = {}
    for key, value in given.items():
        if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
            raise ConfigError(f"{where}.{key} must be a finite number, not {value!r}")
        values[key] = float(value)
    for field in about:
        if field.default is MISSING and field.name not in values:
            raise ConfigError(f"{where} needs '{field.name}'")
    for key in ABOVE_ZERO:
        if values.get(key, 1.0) <= 0:
            raise ConfigError(f"{where}.{key} must be above 0, not {values[key]:g}")
    for key in NOT_BELOW_ZERO:
        if values.get(key, 0.0) < 0:
            raise ConfigError(f"{where}.{key} must not be below 0, not {values[key]:g}")
    return OBJECTS[kind](**values)


def _mapping(value: Any, where: str, known: tuple[str, ...]) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise ConfigError(f"{where} must be a mapping, not {value!r}")
    for key in value:
        if key not in known:
            raise ConfigError(f"{where} has no key '{key}'; it has: {', '.join(known)}")
    return value
