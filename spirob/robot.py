"""What a real, an emulated and a simulated robot have in common: frames in, frames out.

A robot is driven one cycle at a time.  `exchange` sends one command frame and returns the frames
that came back within the cycle.  Everything above (controller, log, filter) sees only this.
"""

from dataclasses import dataclass
from typing import Protocol

from spirob.can_protocol import CanFrame

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

    def prepare(self, scene: Scene) -> None:
        """Bring the arm to rest, straight, tendons just taut, currents zero, in this scene.

        A simulated robot does so at once; a real one asks the operator.
        """

    def exchange(self, command: bytes) -> list[CanFrame]:
        """Send one command payload and return all frames received until the next cycle.

        The command holds for the cycle that follows.  The first frame of the list is the command
        itself, as sent.  Raises HardwareError when a drive stays silent, after commanding zero.
        """

    def close(self) -> None:
        """Command zero current and release the bus; safe to call twice."""
