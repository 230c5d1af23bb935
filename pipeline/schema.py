"""What a configuration may hold: every key, type and range; an unknown key is an error."""

from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from spirob.diagnosis.criteria import ArmCriteria
from spirob.emulator.build import TYPICAL, BuildName
from spirob.errors import ConfigError

UNKNOWN = ("extra_forbidden", "unexpected_keyword_argument")  # kinds of errors: no such key


class Strict(BaseModel):
    """No key that is not declared, no value that is not finite."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Hidden(Strict):
    """What only the emulated robot knows."""

    effect: str
    strength: float = Field(ge=0, le=10)
    seed: int = Field(ge=0)
    built: int | None = Field(None, ge=0)  # seed of the build alone: the same robot built anew


class Emulated(Strict):
    """Pretend hardware behind a virtual CAN bus."""

    kind: Literal["emulated"]
    current_noise: float = Field(0.005, ge=0, le=0.2)
    faults: list[dict[str, Any]] = []  # checked by `spirob.emulator.faults`
    safety: dict[str, float] = {}  # checked by `spirob.can.limits.Limits`
    # both are taken out before any other stage sees the configuration
    build: BuildName = TYPICAL
    hidden: Hidden | None = None


class Simulated(Strict):
    """The model itself as the robot."""

    kind: Literal["simulated"]
    effects: list[str] = []
    changes: dict[str, float] = {}
    safety: dict[str, float] = {}


class Can(Strict):
    """Real hardware."""

    kind: Literal["can"]
    interface: str
    channel: str
    bitrate: int = Field(1_000_000, gt=0)
    drive: str = "c620"  # or another of `spirob/can/drives`, or a description of your own
    options: dict[str, Any] = {}  # further ones of this python-can interface
    safety: dict[str, float] = {}


class PlantConfig(Strict):
    """The model."""

    effects: list[str] = []


class Recordings(Strict):
    """Trials; their own keys are checked by `spirob.trials.Trial`."""

    trials: list[dict[str, Any]] = Field(min_length=1)


class FilterConfig(Strict):
    """Filter of both sides of a residual."""

    kind: Literal["butterworth", "moving_average"] = "butterworth"
    cutoff: float = Field(30.0, gt=0.5, lt=400.0)
    window: int = Field(100, ge=1, le=10_000)
    every: int = Field(10, ge=1, le=1000)


class Identify(Strict):
    """The fit."""

    parameters: list[str] = Field(min_length=1)
    current: Literal["current", "arm_current"] = "current"
    scale: float = Field(0.05, gt=0)
    length: float = Field(5.0, ge=0)
    iterations: int = Field(8, ge=1, le=1000)
    starts: int = Field(16, ge=0, le=4096)
    filter: FilterConfig = FilterConfig()


@dataclass(frozen=True)
class Diagnose(ArmCriteria):
    """The search for missing effects; `candidates` that are considered, the library where empty."""

    candidates: list[str] = field(default_factory=list)
    __pydantic_config__ = ConfigDict(extra="forbid", allow_inf_nan=False)


class Drawn(Strict):
    """Wraps of continuous diameters between the smallest and the largest, for training."""

    count: int = Field(0, ge=0, le=100_000)
    compared: int = Field(300, ge=0, le=100_000)  # the first of them, that the models compared play
    wrap: dict[str, Any] = {}  # what differs from `perceive.wrap`, such as wider variations
    machines: float = Field(0.0, ge=0, lt=1)  # half width by which their numbers vary, relative


class Perceive(Strict):
    """Object size from wrapping."""

    diameters: list[float] = Field(min_length=3)
    repeats: int = Field(ge=1, le=1000)
    unseen: list[float] = Field(min_length=1)
    unseen_repeats: int = Field(ge=1, le=1000)
    unseen_drawn: int = Field(0, ge=0, le=100_000)  # further ones, of continuous diameters
    robot: list[float] = Field(min_length=1)
    robot_repeats: int = Field(ge=1, le=1000)
    predictor: Literal["remainder", "paper"] = "remainder"
    seed: int = Field(0, ge=0)
    wrap: dict[str, Any] = {}
    drawn: Drawn = Drawn()
    size: dict[str, float] = {}  # numbers of the stack, checked by `spirob.perceive.size`
    choose: dict[str, list[float]] = {}  # of them, those that the training chooses, and among what


class Passive(Strict):
    """Pushes that are felt by the current: how many are drawn."""

    in_model: int = Field(200, ge=6, le=100_000)  # to learn where they are
    on_robot: int = Field(60, ge=1, le=10_000)
    free: int = Field(20, ge=0, le=10_000)  # trials on the robot without any, of six seconds
    seed: int = Field(0, ge=0)


class TrialConfig(Strict):
    """Robots with something hidden, to test the diagnosis."""

    kinds: list[str] = []
    seeds: tuple[int, int] = (0, 1)
    nulls: int = Field(0, ge=0, le=10_000)
    without: bool = False
    build: BuildName = TYPICAL
    scheduler: str | None = None  # address of a Dask cluster; else the cores of this machine


class Config(Strict):
    """The whole configuration; `rig` is checked by `spirob.plant.Rig`."""

    rig: dict[str, Any]
    robot: Emulated | Simulated | Can = Field(discriminator="kind")
    plant: PlantConfig
    recordings: Recordings
    paper: dict[str, dict[str, Any]] = {}  # settings, checked by `spirob.experiments`
    identify: Identify
    diagnose: Diagnose
    perceive: Perceive
    passive: Passive = Passive()
    trial: TrialConfig = TrialConfig()

    def public(self) -> dict[str, Any]:
        """As plain data, without what only the emulated robot knows."""
        return self.model_dump(mode="json", exclude={"robot": {"build", "hidden"}})


def validated(plain: Any, source: str) -> Config:
    """Check a configuration; raises ConfigError naming source, key, what was got and why not."""
    try:
        return Config.model_validate(plain)
    except ValidationError as error:
        first = error.errors()[0]
        kinds = ("emulated", "simulated", "can")
        key = ".".join(str(part) for part in first["loc"] if part not in kinds)
        known = ""
        if first["type"] in UNKNOWN:
            known = f"; known here: {', '.join(_siblings(first['loc']))}"
        raise ConfigError(f"{source}: key '{key}': {first['msg']}{known}") from None


def _siblings(location: tuple[int | str, ...]) -> list[str]:
    model: Any = Config
    kinds = {"emulated": Emulated, "simulated": Simulated, "can": Can}
    for part in location[:-1]:
        if part in kinds:
            model = kinds[str(part)]
        elif part in model.model_fields:
            model = model.model_fields[str(part)].annotation
    if is_dataclass(model):
        return [one.name for one in fields(model)]
    return list(getattr(model, "model_fields", {}))
