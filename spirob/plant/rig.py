"""Which machine: nominal numbers of its parts and the gains of its controller."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from spirob.control.law import Gains
from spirob.errors import ConfigError
from spirob.parameter import Numbers
from spirob.plant.nominal import COMPONENTS, Arm, Drive, Holes, Motor, Tendon, Winch

UNITS = (2, 200)  # that an arm may have


@dataclass(frozen=True)
class Rig:
    """Nominal numbers of a machine with two motors, two tendons and a spiral arm."""

    name: str = "spirob"
    units: int = 24
    motor: Motor = field(default_factory=Motor)
    drive: Drive = field(default_factory=Drive)
    winch: Winch = field(default_factory=Winch)
    tendon: Tendon = field(default_factory=Tendon)
    arm: Arm = field(default_factory=Arm)
    holes: Holes = field(default_factory=Holes)
    gains: Gains = field(default_factory=Gains)

    def __post_init__(self) -> None:
        if not UNITS[0] <= self.units <= UNITS[1]:
            raise ConfigError(f"rig: units = {self.units} is out of range {list(UNITS)}")

    @classmethod
    def from_mapping(cls, settings: Mapping[str, object]) -> "Rig":
        """Build from a configuration; parts and numbers not named keep their nominal values.

        Raises ConfigError naming the part and key that is unknown or out of range.
        """
        kinds: tuple[type[Numbers], ...] = (*COMPONENTS, Gains)
        parts = {c.owner: c for c in kinds}
        chosen: dict[str, object] = {}
        for key, value in settings.items():
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
