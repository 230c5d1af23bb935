"""The paper's experiments: what is played, and what is measured on each side that played it.

Here: one side of one trial, robot, model or baseline, as signals; what an experiment is; plans in
plain data.

A file with a class of its own name (`delay.py`, `Delay`) is an experiment: its settings, its
trials, its measure.  No list names it.  What they share:

response.py       when a signal answers, and by how much; the detector's answer to a contact, while
                  a trial is played
passive.py        what the passive ones share: a hit without gear, its figure beside the robot's, a
                  period of several plays;  host_loop.py  what those on the host share
contact_rates.py  how often and how soon contacts are told, over many uncurlings

Measures are pure functions of signals; they do not know who played.  The paper's figure stands
beside ours in every result, and nothing is adjusted to meet it: the paper gives neither the size
nor the stiffness of its arm.
"""

import importlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields
from pkgutil import iter_modules
from typing import Any, ClassVar, Self

import numpy as np

from spirob.errors import ConfigError
from spirob.geometry import PUBLISHED
from spirob.logs.trace import Trace, moving_average
from spirob.plant.plant import Motion
from spirob.robot import CYCLE_NS, MOTORS
from spirob.trials.play import Reaction
from spirob.unit_table import Geometry

WINDOW = 100  # samples, the paper's filter


@dataclass(frozen=True)
class Side:
    """Signals of both motors, columns left and right, one row a cycle of 1 ms.

    current       (T, 2) as the drive reports it [A]; None where there is no motor
    displacement  (T, 2) wound-in length [m];  velocity (T, 2) [m/s]
    command       (T, 2) commanded current [A]
    arm_current   (T, 2) i** of a model [A]; None of all others
    voltage       (T, 2) that the host sent [V]; None where the drive closes the current loop
    parts         of a mean: what it is the mean of, which says how sure it is
    """

    current: np.ndarray | None
    displacement: np.ndarray
    velocity: np.ndarray
    command: np.ndarray
    arm_current: np.ndarray | None = None
    voltage: np.ndarray | None = None
    parts: tuple["Side", ...] = ()

    @classmethod
    def from_trace(cls, trace: Trace) -> "Side":
        """From a log or a simulated trial; raises MissingChannel, and DataError on a NaN."""
        names = ["current", "displacement", "velocity", "command"]
        more = ("arm_current", "voltage")
        names += [name for name in more if f"{MOTORS[0]}.{name}" in trace.signals]
        trace.require_finite([f"{motor}.{name}" for motor in MOTORS for name in names])
        of = {n: np.column_stack([trace[f"{motor}.{n}"] for motor in MOTORS]) for n in names}
        return cls(**of)  # type: ignore[arg-type]

    @classmethod
    def from_motion(cls, motion: Motion, command: np.ndarray) -> "Side":
        """From the baseline, which has tendons and no motors; command [A] is what it was asked."""
        return cls(None, motion.shortening, motion.shortening_rate, command)

    @classmethod
    def mean(cls, sides: Sequence["Side"]) -> "Side":
        """Of one trial played several times, or of such means; a signal that one lacks is out."""
        parts = tuple(part for side in sides for part in side.parts or (side,))
        names = [f.name for f in fields(cls) if f.name != "parts"]
        of = {name: [getattr(part, name) for part in parts] for name in names}
        whole = {n: v for n, v in of.items() if all(one is not None for one in v)}
        means = {n: np.mean(v, axis=0) for n, v in whole.items()}
        return cls(**{"current": None, **means}, parts=parts)

    @property
    def seconds(self) -> np.ndarray:
        """Time since the start [s]."""
        return np.arange(len(self.displacement)) * (CYCLE_NS / 1e9)

    def driven(self, signal: str, motor: int) -> np.ndarray:
        """One motor's signal; "filtered" is the current after the paper's 100-sample mean."""
        name = "current" if signal == "filtered" else signal
        values = getattr(self, name)
        if values is None:
            raise ValueError(f"this side has no {signal}")
        one = np.asarray(values[:, motor], dtype=float)
        return moving_average(one, WINDOW, signal) if signal == "filtered" else one


GIVEN = ("geometry", "told")  # what is no setting
BLOCK = 3  # shots of one part of a mean
LIMIT = 5.0  # A, of every command: the paper's saturation

SIDES = ("robot", "base", "named", "single")
BUILT = "built"  # a side besides: the named model, built anew

# play -> side -> what it did
Sides = Mapping[str, Mapping[str, Any]]


def repeating(model: str) -> str:
    """The side on which a model moves as the robot did."""
    return f"{model}, moved as the robot"


@dataclass(frozen=True)
class Known:
    """What was measured of a robot before it plays, which models of it then have.

    rig      what differs from the rig of the play
    changes  numbers of the model
    """

    rig: dict[str, Any] = field(default_factory=dict)
    changes: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Play:
    """One trial of an experiment.

    name   of the trial, unique within the experiment
    trial  as plain data for `spirob.trials.Trial`
    rig    what differs from the configured rig, for example the bandwidth of the drive
    known  what models have from the robot's own trial before it
    only   the sides that play it; all where empty
    built  seed that a build of the named model is drawn by, which alone plays it, as side `BUILT`
    react  makes what a side does about what it feels; None where it does nothing
    shots  how often a robot plays it, its noise being another each time, for their mean; `BLOCK`
           of them are one of its parts
    first  how many shots of it were played before
    noisy  whether a model's current has the sensor's noise as the robot's has, the mean of as many
           draws as there are shots, and a loop on the host reads it in the drive's counts
    repeat makes, of the robot's side, what a model does to move as the robot did, whatever it feels
           itself; the models then play the trial twice, see `repeating`
    """

    name: str
    trial: dict[str, Any]
    rig: dict[str, Any] = field(default_factory=dict)
    known: Known = field(default_factory=Known)
    only: tuple[str, ...] = ()
    built: int | None = None
    shots: int = 1
    first: int = 0
    noisy: bool = False
    react: Callable[[], Reaction] | None = None
    repeat: Callable[[Side], Reaction] | None = None


@dataclass(frozen=True, kw_only=True)
class Experiment(ABC):
    """Base of all experiments; a subclass is a frozen dataclass whose fields are its settings.

    geometry  of the arm, by whose length places count; no setting
    """

    title: ClassVar[str]
    about: ClassVar[str] = ""  # what the report says of it, in a sentence or two
    motor: ClassVar[int] = 0  # the one that is looked at

    geometry: Geometry = PUBLISHED

    def before(self) -> Play | None:
        """A trial of the robot alone that comes before all others; None where none is needed."""
        return None

    def informed(self, side: Side) -> Self:
        """The same experiment with what the robot's trial `before` has told."""
        return self

    @abstractmethod
    def plays(self) -> list[Play]:
        """Every trial to be played, on every side."""

    def more(self, sides: Sides) -> list[Play]:
        """What has to be played beside `plays`, by what the sides did so far; none: enough.

        Shots of a play that is known join those that were played.
        """
        return []

    @abstractmethod
    def measure(self, sides: Sides) -> list[dict[str, Any]]:
        """Figures as rows `{what, unit, robot, base, named, single, paper, aim, met, note}`.

        met  of an aim that cannot be judged: a word or two why, which the note says in full
        """

    @abstractmethod
    def curves(self, sides: Sides) -> list[dict[str, Any]]:
        """What the report draws: `{play, quantity, unit, side, x, y}`, thinned."""


def experiments() -> dict[str, type[Experiment]]:
    """All experiments by name: a file here that holds a class of its own name is one."""
    found = {}
    for name in (info.name for info in iter_modules(__path__)):
        module = importlib.import_module(f"{__name__}.{name}")
        kind = getattr(module, name.title().replace("_", ""), None)
        if isinstance(kind, type) and issubclass(kind, Experiment):
            found[name] = kind
    return found


def experiment_from(name: str, given: Any, geometry: Geometry = PUBLISHED) -> Experiment:
    """An experiment with the settings of a preset; raises ConfigError naming experiment and key."""
    if name not in (every := experiments()):
        raise ConfigError(f"no experiment '{name}'; known: {', '.join(every)}")
    kind = every[name]
    if not isinstance(given, Mapping):
        raise ConfigError(f"paper.{name} must be a mapping of settings, not {given!r}")
    known = {about.name: about for about in fields(kind) if about.name not in GIVEN}
    for key, value in given.items():
        if key not in known:
            raise ConfigError(f"paper.{name} has no key '{key}'; it has: {', '.join(known)}")
        _require_number(f"paper.{name}.{key}", value, known[key].default)
    values = {k: tuple(v) if isinstance(v, list) else v for k, v in given.items()}
    return kind(geometry=geometry, **values)


def _require_number(where: str, value: Any, default: Any) -> None:
    if default is not MISSING and isinstance(default, tuple):
        if not isinstance(value, list | tuple) or not value:
            raise ConfigError(f"{where} must be a list of numbers, not {value!r}")
        for item in value:
            _require_number(where, item, 0.0)
        return
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise ConfigError(f"{where} must be a finite number, not {value!r}")
    if value < 0:
        raise ConfigError(f"{where} = {value} must not be below 0")
    if isinstance(default, int) and not isinstance(value, int):
        raise ConfigError(f"{where} = {value} must be a whole number")


def plan(mode: str, profile: dict[str, Any]) -> dict[str, Any]:
    """What is asked of one motor."""
    return {"mode": mode, "current_limit": LIMIT, "profile": profile}


def trial(
    name: str,
    duration: float,
    left: dict[str, Any],
    right: dict[str, Any],
    scene: dict[str, Any] | None = None,
) -> dict[str, Any]:
    """A trial as plain data; experiments are only looked at, so every one is held out."""
    motors = {"left": left, "right": right}
    plain = {"name": name, "role": "heldout", "duration": float(duration), "motors": motors}
    return plain | ({"scene": scene} if scene else {})


def row(what: str, unit: str, values: Mapping[str, Any], **more: Any) -> dict[str, Any]:
    """One line of an experiment's table; a figure that is not finite is left out as None."""
    known = {"paper": None, "aim": None, "met": None, "note": ""}
    sides = {s: _figure(values.get(s)) for s in SIDES}
    return {"what": what, "unit": unit, **sides, **known, **more}


def curve(
    play: str, quantity: str, unit: str, side: str, x: np.ndarray, y: np.ndarray, every: int = 20
) -> dict[str, Any]:
    """One line of a figure, every so many samples."""
    return {
        "play": play,
        "quantity": quantity,
        "unit": unit,
        "side": side,
        "x": np.round(x[::every], 6).tolist(),
        "y": np.round(y[::every], 6).tolist(),
    }


def aimed(values: Mapping[str, Any], share: float) -> dict[str, Any]:
    """Aim of a row that the named model lies within a share of the robot's figure, and whether.

    met  None where one of the two is missing
    """
    named, robot = values.get("named"), values.get("robot")
    met = None
    if named is not None and robot is not None and np.isfinite([named, robot]).all():
        met = bool(abs(named - robot) <= share * abs(robot))
    return {"aim": f"named within {100 * share:g} % of the robot", "met": met}


def _figure(value: Any) -> Any:
    if value is None or isinstance(value, str | bool):
        return value
    return float(f"{value:.6g}") if np.isfinite(value) else None
