"""Which machine: nominal numbers of its parts with bounds and source, gains of its controller."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from spirob.control import Gains, HostLoop, Placed, placed
from spirob.errors import ConfigError
from spirob.geometry import PUBLISHED, UNITS, Drawing, SpiralArm
from spirob.parameter import Numbers, bounded
from spirob.unit_table import Geometry, Measured

PAPER = "Alsarraj et al. 2026, sim-to-real identification"
DRIVE_SHEET = "M3508/C620 class drive, published by several firmwares"
BRAID = "braided line of 1 mm, half a metre; data sheets leave its stretch open by this much"
DESIGN = "SpiRobs design tool and published models; they differ by a factor of ten"


class Motor(Numbers):
    """Winding and rotor."""

    owner = "motor"

    resistance: float = bounded(0.194, 0.01, 20.0, "Ω", "R", "phase resistance", DRIVE_SHEET)
    inductance: float = bounded(9.7e-5, 1e-6, 0.1, "H", "L", "phase inductance", DRIVE_SHEET)
    torque_constant: float = bounded(
        0.0203, 1e-3, 2.0, "N·m/A", "k_t", "torque per current at the rotor", DRIVE_SHEET
    )
    emf_constant: float = bounded(
        0.0203, 1e-3, 2.0, "V·s/rad", "k_e", "back-EMF per rotor speed", DRIVE_SHEET
    )
    rotor_inertia: float = bounded(
        2e-5, 5e-6, 5e-4, "kg·m²", "J_m", "inertia of the rotor", PAPER, log=True
    )
    rotor_inertia_difference: float = bounded(
        0.0, -0.3, 0.3, "1", "δJ", "half of left minus right rotor's inertia, over their mean"
    )
    rotor_damping: float = bounded(
        1e-4, 1e-5, 1e-3, "N·m·s/rad", "b_m", "viscous friction of the rotor", PAPER, log=True
    )
    rotor_damping_difference: float = bounded(
        0.0, -0.5, 0.5, "1", "δb", "half of left minus right rotor's damping, over their mean"
    )
    rest_speed: float = bounded(
        2.0, 1e-6, 100.0, "rad/s", "ω_0", "below it the rotor counts as standing", log=True
    )


class Drive(Numbers):
    """The drive's inner current loop, faster than the bus."""

    owner = "drive"

    rate: float = bounded(20000.0, 2000.0, 1e5, "Hz", "f_d", "rate of the current loop")
    bandwidth: float = bounded(1000.0, 1.0, 4000.0, "Hz", "f_c", "bandwidth of the current loop")
    emf_compensation: float = bounded(1.0, 0.0, 1.0, "1", "c_e", "fed-forward share of back-EMF")
    voltage_limit: float = bounded(24.0, 1.0, 100.0, "V", "U", "supply voltage", DRIVE_SHEET)
    current_limit: float = bounded(5.0, 0.1, 100.0, "A", "I", "limit of the current command", PAPER)


class Winch(Numbers):
    """Gear and drum."""

    owner = "winch"

    gear_ratio: float = bounded(3591 / 187, 1.0, 200.0, "1", "G", "rotor turns per drum turn")
    radius: float = bounded(0.02, 1e-3, 0.2, "m", "r", "radius of the drum")
    efficiency: float = bounded(
        0.77, 0.6, 1.0, "1", "η", "torque transmitted by the gear", PAPER, tolerance=0.15
    )
    efficiency_difference: float = bounded(
        0.0, -0.2, 0.2, "1", "δη", "half of left minus right gear's efficiency, over their mean"
    )
    drum_inertia: float = bounded(
        0.0, 0.0, 5e-4, "kg·m²", "J_w", "inertia of the drum; behind a gear G² times less than J_m"
    )
    radius_difference: float = bounded(
        0.0, -0.05, 0.05, "1", "δr", "half of left minus right drum's radius, over their mean"
    )


class Tendon(Numbers):
    """The elastic, one-sided tendon."""

    owner = "tendon"

    stiffness: float = bounded(
        4e4, 5e3, 1e6, "N/m", "k", "tension per stretch", BRAID, log=True, tolerance=0.4
    )
    damping: float = bounded(20.0, 0.0, 200.0, "N·s/m", "c", "tension per rate of stretch")


class Arm(Numbers):
    """The chain of hinges."""

    owner = "arm"

    base_stiffness: float = bounded(
        0.15, 0.01, 2.0, "N·m/rad", "k_1", "stiffness of the base hinge", DESIGN, log=True
    )
    stiffness_exponent: float = bounded(
        1.5, 0.5, 3.5, "1", "e", "stiffness falls as size to this power", DESIGN
    )
    stiffness_bow: float = bounded(
        0.0, -1.0, 1.0, "1", "c", "log of the stiffness half-way, over what the power law gives"
    )
    damping_time: float = bounded(
        0.02,
        1e-3,
        0.4,
        "s",
        "τ_d",
        "damping over stiffness of each hinge",
        DESIGN,
        log=True,
        times="arm.base_stiffness",
    )
    bends_per_hinge: float = bounded(
        1.0,
        0.5,
        16.0,
        "1",
        "n",
        "equal bends into which a hinge's bend is spread; 1 is a point between rigid units",
        log=True,
    )
    density: float = bounded(
        540.0, 50.0, 3000.0, "kg/m³", "ρ", "TPU 1200 kg/m³ at 45 % fill", DESIGN, log=True
    )
    thickness_ratio: float = bounded(0.6, 0.1, 2.0, "1", "h", "thickness over width", DESIGN)
    armature: float = bounded(
        5e-5, 0.0, 1e-3, "kg·m²", "I_a", "added inertia of the base hinge; falls as size squared"
    )
    limit_ratio: float = bounded(
        0.96, 0.5, 0.99, "1", "q_max/Δθ", "end stop; at 1 the guides coincide and length has a cusp"
    )
    gravity_x: float = bounded(0.0, -20.0, 20.0, "m/s²", "g_x", "gravity along the straight arm")
    gravity_y: float = bounded(0.0, -20.0, 20.0, "m/s²", "g_y", "gravity across the arm, in plane")
    contact_friction: float = bounded(0.3, 0.0, 2.0, "1", "μ_c", "friction of the arm's surface")


class Holes(Numbers):
    """Where the tendons' holes lie on the units, from the drawing's; a rig's arm narrows the bounds
    (`plant.tendon`)."""

    owner = "holes"

    shift: float = bounded(
        0.0, -0.5, 0.5, "1", "σ", "shift of each unit's hole to the tip, over the unit's length"
    )
    height: float = bounded(1.0, 0.6, 1.1, "1", "κ", "height of all holes, over the drawing's")
    mount: float = bounded(
        0.0, -0.1, 0.3, "m", "x_0", "how far the mount's hole lies behind the mount's face"
    )


COMPONENTS: tuple[type[Numbers], ...] = (Motor, Drive, Winch, Tendon, Arm, Holes)


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
