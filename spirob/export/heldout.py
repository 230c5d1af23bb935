"""The held-out logs of a diagnosis, and what a model that is played elsewhere makes of them.

`Heldout` are those of a rig, `ArmHeldout` the trials of an arm; `PLAYED` has a function for each
target in which an arm can be played: model, folder -> currents.  `left_out` says how large an
effect of the model is on them: what leaving it out costs.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from spirob.control import CURRENT
from spirob.effects import Effect
from spirob.errors import ExportError
from spirob.export.arm import CorrectedArm, lever_of, motor_of, reported_lever
from spirob.export.axis import equations
from spirob.export.code import c_name, python_text
from spirob.export.corrected import Corrected, Held
from spirob.export.targets import played_alone
from spirob.identify.measurement import Measurement
from spirob.identify.problem import rms
from spirob.logs.trace import read_table
from spirob.machine.inverse.motion import Motion, late
from spirob.machine.recordings.recording import Recording
from spirob.plant.records import Response
from spirob.plant.session import CYCLE
from spirob.robot import MOTORS

FILE = "heldout.parquet"
COLUMNS = (
    "time", "position", "speed", "acceleration", "effort", "carried", "payload", "offset",
    "along", "across",
)  # fmt: skip


@dataclass(frozen=True)
class Errors:
    """RMS over the held-out rows, in the unit of the effort.

    ours, exported  model less measurement, of the model here and of the exported one
    apart           the one less the other;  size  of what the effects do together
    """

    ours: float
    exported: float
    apart: float
    size: float

    @property
    def lost(self) -> float:
        """What the export loses, as a share of the effects' size; of the effort without any."""
        return self.apart / self.size if self.size > 0.0 else np.inf * self.apart


class Heldout:
    """The rows of the held-out logs.

    starts (pieces + 1,), steps (pieces,)  where pieces begin, and their sample periods [s]
    """

    def __init__(self, model: Corrected):
        path = model.folder / FILE
        try:
            self.table = read_table(path)
        except (OSError, ValueError) as error:
            why = " ".join(str(error).split())[:100]
            raise ExportError(f"{path}: cannot be read ({why}); diagnose again") from None
        needed = {"trial", "piece", "used", "modelled", "without", *COLUMNS}
        if missing := sorted(needed - set(self.table.columns)):
            raise ExportError(f"{path}: has no column '{missing[0]}'; diagnose again")
        self.model = model
        own = self.table[["trial", "piece"]].to_numpy()
        cuts = np.flatnonzero(np.any(np.diff(own, axis=0) != 0, axis=1)) + 1
        self.starts = np.array([0, *cuts, len(own)])
        self._trials = own[self.starts[:-1], 0]
        try:
            self.steps = np.array([float(model.trials[k]["period"]) for k in self._trials])
        except (IndexError, KeyError, TypeError, ValueError):
            raise ExportError(f"{path}: belongs to another diagnosis; diagnose again") from None

    def given(self) -> dict[str, np.ndarray]:
        """What a target's `play` needs."""
        kept = [str(n) for n in self.table.columns if n not in ("used", "trial")]
        found = {name: self.table[name].to_numpy(float) for name in kept}
        numbers, q = self.model.numbers, found["position"]
        turned = q if self.model.axis == "rad" else np.zeros_like(q)
        weight = numbers["payload_cosine"] * np.cos(turned)
        weight += numbers["payload_sine"] * np.sin(turned)
        one = numbers["payload_inertia"] * found["acceleration"] + weight
        found["hung"] = found["offset"] + found["payload"] * one
        usual = self.model.usual
        hung = usual["offset"] + (0.0 if self.model.body else usual["payload"] * one)
        return found | {
            "beside": found["hung"] - hung,  # of what goes with the exported body
            "starts": self.starts,
            "steps": self.steps,
        }

    def errors(self, effort: np.ndarray, framed: np.ndarray) -> Errors:
        """How far a played effort is from the measurement, and from the model here.

        effort  as reported, before the delay between motion and log, (n,)
        framed  the measured effort as late as the frame of a bus brings it, (n,)
        """
        table = self.table
        measured = table["effort"].to_numpy(float)
        played = late(effort, self.model.numbers["delay"], self._motion()) + measured - framed
        ours, bare = (table[n].to_numpy(float) for n in ("modelled", "without"))
        used = table["used"].to_numpy(bool)

        def size(values: np.ndarray) -> float:
            return rms(self._last(values)[used])

        return Errors(
            size(ours - measured),
            size(played - measured),
            size(played - ours),
            size(ours - bare if self.model.effects else measured),
        )

    def _motion(self) -> Motion:
        none = np.zeros(len(self.table))
        return Motion(self.starts, self.steps, none, none, none, none, none, {})

    def _last(self, values: np.ndarray) -> np.ndarray:
        """The filter that measured and modelled effort pass."""
        out = np.empty_like(values)
        for k, trial in enumerate(self._trials):
            about = self.model.trials[trial]
            rows = slice(self.starts[k], self.starts[k + 1])
            filters = Recording("", about["period"], about["cutoff"], about["every"], [], [])
            out[rows] = filters.last(values[rows])
        return out


def there(folder: Path) -> bool:
    """Whether a diagnosis has its held-out logs beside it."""
    return (folder / FILE).is_file()


def left_out(model: Corrected, one: Held) -> str:
    """The error of leaving an effect out, in words."""
    if not there(model.folder):
        return "of unknown size, as the diagnosis has no held-out logs beside it"
    heldout = Heldout(model)
    whole = effort_of(model, heldout)
    less = effort_of(
        replace(model, effects=tuple(e for e in model.effects if e is not one)), heldout
    )
    used = heldout.table["used"].to_numpy(bool)
    missing = float(np.sqrt(np.mean((whole - less)[used] ** 2)))
    size = rms(heldout.table["effort"].to_numpy(float)[used])
    return f"costs {missing:.3g} {model.effort} RMS, {missing / size:.2%} of the effort"


def effort_of(model: Corrected, heldout: Heldout) -> np.ndarray:
    """The effort that a model asks for along the held-out logs, as they are logged, (n,)."""
    given, names = heldout.given(), dict[str, Any]()
    exec(compile(python_text(model), "exported", "exec"), names)  # of checked arithmetic alone
    state, n = names["State"](), len(given["position"])
    effort, framed = np.zeros(n), np.zeros(n)
    fed = {"carried": "carried", "payload": "payload", "offset": "offset"}
    fed |= {"weight_x": "along", "weight_y": "across"}
    rows = [given[name].tolist() for name in ("position", "speed", "acceleration", "effort")]
    for k, dt in enumerate(heldout.steps.tolist()):
        inside = range(heldout.starts[k], heldout.starts[k + 1])
        state.reset()
        state.time = float(given["time"][inside[0]])
        for row in inside:
            for field, column in fed.items():
                setattr(state, field, float(given[column][row]))
            q, v, a, _ = (x[row] for x in rows)
            effort[row] = names["compensate"](state, q, v, a, dt)
        for out, function, values in (
            (effort, names["reported"], effort.tolist()),
            (framed, names["framed"], rows[3]),
        ):
            _through(function, state, out, values, inside, dt)
    return effort + given["effort"] - framed


def _through(
    function: Callable[..., float],
    state: Any,
    out: np.ndarray,
    values: list[float],
    rows: range,
    dt: float,
) -> None:
    state.reset()
    for row in rows:
        out[row] = function(state, values[row], dt)


class ArmHeldout:
    """What the model makes of the trials in which the arm moves freely.

    Compared are the currents of motors that are not themselves commanded a current.
    """

    def __init__(self, model: CorrectedArm):
        self.model, self.plant, self.trials = model, model.plant(), model.trials()

    @cached_property
    def ours(self) -> list[Response]:
        """The trials as the model here plays them."""
        return self._simulated({})

    def errors(self, exported: list[np.ndarray]) -> Errors:
        """How far currents, (T, 2) of each trial, are from the measurement and from the model."""
        measured = self._driven([t.current for t in self.trials])
        ours, played = self._driven([r.current for r in self.ours]), self._driven(exported)
        size = self.size(self.model.effects) if self.model.effects else rms(measured)
        return Errors(rms(ours - measured), rms(played - measured), rms(played - ours), size)

    def size(self, effects: tuple[type[Effect], ...]) -> float:
        """What these effects do to the currents together, RMS [A]."""
        return self.change({f"{e.name()}.{f}": v for e in effects for f, v in e.neutral.items()})

    def change(self, numbers: dict[str, float]) -> float:
        """By how much the currents change with other numbers, RMS [A]."""
        other = self._driven([r.current for r in self._simulated(numbers)])
        return rms(self._driven([r.current for r in self.ours]) - other)

    def left_out(self, numbers: dict[str, float]) -> str:
        """The error of numbers that a target takes instead, in words."""
        whole, size = rms(self._driven([t.current for t in self.trials])), self.change(numbers)
        return f"costs {size:.3g} A RMS, {size / whole:.2%} of the current"

    def _simulated(self, numbers: dict[str, float]) -> list[Response]:
        changes = {**self.model.changes, **numbers}
        return [
            self.plant.simulate(t.schedule, t.scene, changes, t.first_angle) for t in self.trials
        ]

    def _driven(self, values: list[np.ndarray]) -> np.ndarray:
        pairs = zip(values, self.trials, strict=True)
        return np.concatenate(
            [v[compared(t)][:, t.schedule.mode != CURRENT].ravel() for v, t in pairs]
        )


def compared(trial: Measurement) -> np.ndarray:
    """Which cycles of a trial are compared, (T,)."""
    return np.ones(len(trial.current), bool) if trial.use is None else trial.use


def _coupled(heldout: ArmHeldout, folder: Path) -> list[np.ndarray]:
    """The loop beside plain MuJoCo, under the controller of the trials."""
    given: dict[str, np.ndarray] = {}
    for k, t in enumerate(heldout.trials):
        said = t.schedule
        given |= {f"mode_{k}": said.mode, f"limit_{k}": said.current_limit}
        given |= {f"reference_{k}": said.reference, f"rate_{k}": said.reference_rate}
        given[f"angle_{k}"] = np.array(t.first_angle)
    about = {"name": c_name(heldout.model.name), "trials": len(heldout.trials)}
    made = played_alone("mujoco", folder, about, given)
    return [made[f"current_{k}"] for k in range(len(heldout.trials))]


def _led(heldout: ArmHeldout, folder: Path) -> list[np.ndarray]:
    """Plain MJCF, whose drives lead its winches as they move in the model here."""
    model, given = heldout.model, dict[str, np.ndarray]()
    lever = np.array([lever_of(model, m) for m in MOTORS])
    wound = lever / reported_lever(model)
    for k, (trial, ours) in enumerate(zip(heldout.trials, heldout.ours, strict=True)):
        given |= {f"length_{k}": wound * ours.displacement, f"rate_{k}": wound * ours.velocity}
        given[f"first_{k}"] = lever * np.array(trial.first_angle)
        given |= {f"current_{k}": ours.command, f"led_{k}": trial.schedule.mode != CURRENT}
    about = {
        "name": c_name(model.name),
        "trials": len(heldout.trials),
        "motors": list(MOTORS),
    }
    made = played_alone("mjcf", folder, about, given)
    return [made[f"current_{k}"] for k in range(len(heldout.trials))]


def _motors(to: str) -> Callable[[ArmHeldout, Path], list[np.ndarray]]:
    """Each motor as an axis: the tendon moves and pulls as in the model here."""

    def play(heldout: ArmHeldout, folder: Path) -> list[np.ndarray]:
        lengths = [len(r.current) for r in heldout.ours]
        starts = np.cumsum([0, *lengths])
        found = np.zeros((starts[-1], 2))
        for m, motor in enumerate(MOTORS):
            axis, lever = motor_of(heldout.model, motor), lever_of(heldout.model, motor)
            turn = 1.0 / reported_lever(heldout.model)
            rows = [
                _rows(ours, trial.first_angle[m], turn, lever, m)
                for ours, trial in zip(heldout.ours, heldout.trials, strict=True)
            ]
            given = {n: np.concatenate([row[n] for row in rows]) for n in rows[0]}
            given |= {"starts": starts, "steps": np.full(len(lengths), CYCLE)}
            about = {"name": c_name(axis.name), "fields": list(equations(axis).state)}
            made = played_alone(to, folder, about, given)
            found[:, m] = made["effort"] + given["effort"] - made["framed"]
        return np.split(found, starts[1:-1])

    return play


def _rows(ours: Response, first: float, turn: float, lever: float, m: int) -> dict[str, np.ndarray]:
    """One motor's motion in rotor coordinates, and the torque of its tendon.

    turn  of the rotor for a metre that the drive reports [rad/m];  lever  of the tendon's force [m]
    """
    speed = turn * ours.velocity[:, m]
    none = np.zeros(len(speed))
    return {
        "time": CYCLE * np.arange(len(speed)),
        "position": first + turn * ours.displacement[:, m],
        "speed": speed,
        "acceleration": np.gradient(speed, CYCLE),
        "effort": ours.current[:, m],
        "carried": lever * ours.tension[:, m],
        **dict.fromkeys(("payload", "offset", "hung", "along", "across"), none),
    }


PLAYED: dict[str, Callable[[ArmHeldout, Path], list[np.ndarray]]] = {
    "mujoco": _coupled,
    "mjcf": _led,
    "c": _motors("c"),
    "bam": _motors("bam"),
}


def played_arm(model: CorrectedArm, to: str, folder: Path) -> Errors:
    """The errors of an arm that was exported to a folder for a target, on the trials kept aside."""
    heldout = ArmHeldout(model)
    return heldout.errors(PLAYED[to](heldout, folder))


def arm_left_out(model: CorrectedArm, instead: dict[str, dict[str, float]]) -> dict[str, str]:
    """The error of what a target leaves out, in words: name -> numbers that it takes instead."""
    try:
        heldout = ArmHeldout(model)
    except ExportError:
        unknown = "of unknown size, as no trial of the arm was kept aside"
        return dict.fromkeys(instead, unknown)
    return {name: heldout.left_out(numbers) for name, numbers in instead.items()}
