"""What a real, an emulated and a simulated robot have in common: frames in, frames out.

A robot is driven one cycle at a time.  `exchange` sends one command frame and returns the frames
that came back within the cycle.  Everything above (controller, log, filter) sees only this.
"""

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Any, Protocol

import numpy as np

from spirob.can_protocol import CanFrame
from spirob.errors import ConfigError

MOTORS = ("left", "right")  # left: the tendon on the +y side of the arm
CYCLE_NS = 1_000_000  # 1 kHz


@dataclass(frozen=True)
class Cylinder:
    """A fixed object on the table, its axis parallel to the hinges.

    diameter [m]; x, y of its centre [m] in the frame of the straight arm; Coulomb friction [-]
    """

    diameter: float
    x: float
    y: float
    friction: float = 0.3


@dataclass(frozen=True)
class Ball:
    """A ball that flies freely over the table, in the plane of the arm.

    diameter [m]; mass [kg]; x, y of its centre [m] and its velocity vx, vy [m/s] when the trial
    begins; Coulomb friction [-].  It does not spin, and gravity does not act on it.
    """

    diameter: float
    mass: float
    x: float
    y: float
    vx: float
    vy: float
    friction: float = 0.3


@dataclass(frozen=True)
class Peg:
    """A round peg that runs on a circle at constant speed, whatever it meets.

    diameter [m]; x, y of the circle's centre, its radius [m]; period of a turn [s], anticlockwise;
    phase at the start [rad], 0 is on the +x side of the centre; Coulomb friction [-]
    """

    diameter: float
    x: float
    y: float
    radius: float
    period: float
    phase: float = 0.0
    friction: float = 0.3


@dataclass(frozen=True)
class Weights:
    """Known weights on the winches, each on a line of its own wound beside the tendon.

    left, right  mass [kg], lifted by winding in, let go when the trial begins; 0 is none.  The line
    stays taut while the drum gives way more slowly than the weight would fall.
    """

    left: float = 0.0
    right: float = 0.0


@dataclass(frozen=True)
class Scene:
    """What surrounds the arm in a trial, or hangs on its winches: nothing, or one of these."""

    cylinder: Cylinder | None = None
    ball: Ball | None = None
    peg: Peg | None = None
    weights: Weights | None = None

    @property
    def touchable(self) -> bool:
        """Whether there is an object that the arm may touch."""
        return any((self.cylinder, self.ball, self.peg))


class Robot(Protocol):
    """A robot behind a CAN bus."""

    def prepare(self, scene: Scene, trial: str = "trial") -> None:
        """Bring the arm to rest, straight, tendons just taut, currents zero, in this scene.

        A simulated robot does so at once; a real one asks the operator.  The noise of an emulated
        one belongs to the trial's name.
        """

    def exchange(self, command: bytes) -> list[CanFrame]:
        """Send one command payload and return all frames received until the next cycle.

        The command holds for the cycle that follows.  The first frame of the list is the command
        itself, as sent.  Raises HardwareError when a drive stays silent, after commanding zero.
        """

    def close(self) -> None:
        """Command zero current and release the bus; safe to call twice."""


OBJECTS: dict[str, type] = {
    "cylinder": Cylinder,
    "ball": Ball,
    "peg": Peg,
    "weights": Weights,
}


ABOVE_ZERO = ("diameter", "mass", "radius", "period")


NOT_BELOW_ZERO = ("friction", "left", "right")


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
