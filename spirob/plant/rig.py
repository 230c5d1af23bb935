"""Which machine: nominal numbers of its parts and the gains of its controller."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from spirob.control.host_gains import Placed, placed
from spirob.control.host_loop import HostLoop
from spirob.control.law import Gains
from spirob.errors import ConfigError
from spirob.parameter import Numbers
from spirob.plant.nominal import COMPONENTS, Arm, Drive, Holes, Motor, Tendon, Winch

UNITS = (2, 200)  # that an arm may have
LOOPS = ("drive", "host")  # where the current loop is closed


@dataclass(frozen=True)
class Rig:
    """Nominal numbers of a machine with two motors, two tendons and a spiral arm.

    host  the current loop where the host closes it; None where the drive does
    """

    name: str = "spirob"
    units: int = 24
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

    def placed(self) -> Placed | None:
        """Gains of the host's loop by the nominal winding; ConfigError where they are unstable."""
        if self.host is None:
            return None
        return placed(self.host, self.motor.resistance, self.motor.inductance)

    @classmethod
    def from_mapping(cls, settings: Mapping[str, object]) -> "Rig":
        """Build from a configuration; parts and numbers not named keep their nominal values.

        `drive.loop: host` closes the current loop on the host, by the numbers under `drive.host`.
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
            elif key == "units" and isinstance(value, int):
                chosen[key] = value
            else:
                known = ", ".join(["name", "units", *parts])
                raise ConfigError(f"rig has no part '{key}'; it has: {known}")
        return cls(**chosen)  # type: ignore[arg-type]

    def parts(self) -> list[tuple[str, Numbers]]:
        """The model's parts with their names, in the order of the parameter vector."""
        return [(c.owner, getattr(self, c.owner)) for c in COMPONENTS]


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
