"""Which machine: nominal numbers of its parts and the gains of its controller."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from spirob.control.host_gains import Placed, placed
from spirob.control.host_loop import HostLoop
from spirob.control.law import Gains
from spirob.errors import ConfigError
from spirob.geometry import PUBLISHED, UNITS, Drawing, SpiralArm
from spirob.parameter import Numbers
from spirob.plant.nominal import COMPONENTS, Arm, Drive, Holes, Motor, Tendon, Winch
from spirob.unit_table import Geometry, Measured

LOOPS = ("drive", "host")  # where the current loop is closed


@dataclass(frozen=True)
class Rig:
    """Nominal numbers of a machine with two motors, two tendons and a spiral arm.

    geometry  what the arm is: as drawn, or as measured
    cut       into how many units the model cuts it; None: those that it has
    host      the current loop where the host closes it; None where the drive does
    """

    name: str = "spirob"
    geometry: Geometry = PUBLISHED
    cut: int | None = None
    motor: Motor = field(default_factory=Motor)
    drive: Drive = field(default_factory=Drive)
    winch: Winch = field(default_factory=Winch)
    tendon: Tendon = field(default_factory=Tendon)
    arm: Arm = field(default_factory=Arm)
    holes: Holes = field(default_factory=Holes)
    gains: Gains = field(default_factory=Gains)
    host: HostLoop | None = None

    def __post_init__(self) -> None:
        self.placed()
        if not UNITS[0] <= self.units <= UNITS[1]:
            raise ConfigError(f"rig: units = {self.units} is out of range {list(UNITS)}")

    @property
    def units(self) -> int:
        """Units, and hinges, of the model."""
        return self.geometry.units if self.cut is None else self.cut

    def lengths(self) -> SpiralArm:
        """The arm's lengths, cut as the model cuts it."""
        return self.geometry.arm(self.units)

    def placed(self) -> Placed | None:
        """Gains of the host's loop by the nominal winding; ConfigError where they are unstable."""
        if self.host is None:
            return None
        return placed(self.host, self.motor.resistance, self.motor.inductance)

    @classmethod
    def from_mapping(cls, settings: Mapping[str, object]) -> "Rig":
        """Build from a configuration; parts and numbers not named keep their nominal values.

        `drive.loop: host` closes the current loop on the host, by the numbers under `drive.host`.
        `geometry` holds the design tool's numbers, or `rows` of a table (`spirob.unit_table`).
        Raises ConfigError naming the part and key that is unknown or out of range.
        """
        kinds: tuple[type[Numbers], ...] = (*COMPONENTS, Gains)
        parts = {c.owner: c for c in kinds}
        chosen: dict[str, object] = {}
        for key, value in settings.items():
            if key == "drive" and isinstance(value, Mapping):
                value, chosen["host"] = _loop(value)
            if key in parts and isinstance(value, Mapping):
                chosen[key] = parts[key].from_mapping(value)
            elif key == "name":
                chosen[key] = str(value)
            elif key == "units" and isinstance(value, int) and not isinstance(value, bool):
                chosen["cut"] = value
            elif key == "geometry" and isinstance(value, Mapping):
                chosen[key] = _geometry(value)
            else:
                known = ", ".join(["name", "units", "geometry", *parts])
                raise ConfigError(f"rig has no part '{key}'; it has: {known}")
        return cls(**chosen)  # type: ignore[arg-type]

    def parts(self) -> list[tuple[str, Numbers]]:
        """The model's parts with their names, in the order of the parameter vector."""
        return [(c.owner, getattr(self, c.owner)) for c in COMPONENTS]


def _geometry(given: Mapping[str, Any]) -> Geometry:
    if "rows" not in given:
        return Drawing.from_mapping(given)
    rows = given["rows"]
    if len(given) > 1 or isinstance(rows, str) or not isinstance(rows, Sequence):
        raise ConfigError("geometry.rows: a list of rows, and no other key beside it")
    try:
        return Measured.from_rows(rows)
    except ConfigError as error:
        raise ConfigError(f"geometry: {error}") from None


def _loop(drive: Mapping[str, Any]) -> tuple[dict[str, Any], HostLoop | None]:
    """The drive's own numbers, and the loop on the host where one is asked for."""
    numbers = dict(drive)
    where, given = numbers.pop("loop", LOOPS[0]), numbers.pop("host", {})
    if where not in LOOPS:
        raise ConfigError(f"rig: drive.loop is {' or '.join(LOOPS)}, not {str(where)[:40]!r}")
    if not isinstance(given, Mapping):
        raise ConfigError(f"rig: drive.host must be a mapping of numbers, not {str(given)[:40]!r}")
    loop = HostLoop.from_mapping(given)
    assert isinstance(loop, HostLoop)
    return numbers, loop if where == "host" else None
