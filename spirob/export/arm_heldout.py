"""The trials of an arm that were kept aside, and what an exported arm makes of them.

`PLAYED` has a function for each target that can be played: model, folder -> currents.
"""

from collections.abc import Callable
from functools import cached_property
from pathlib import Path

import numpy as np

from spirob.control import CURRENT
from spirob.effects import Effect
from spirob.errors import ExportError
from spirob.export.arm import CorrectedArm, lever_of, motor_of, reported_lever
from spirob.export.axis import equations
from spirob.export.code import c_name
from spirob.export.heldout import Errors, played_alone
from spirob.identify.measurement import Measurement
from spirob.plant.records import Response
from spirob.plant.session import CYCLE
from spirob.robot import MOTORS


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
        size = self.size(self.model.effects) if self.model.effects else _rms(measured)
        return Errors(_rms(ours - measured), _rms(played - measured), _rms(played - ours), size)

    def size(self, effects: tuple[type[Effect], ...]) -> float:
        """What these effects do to the currents together, RMS [A]."""
        return self.change({f"{e.name()}.{f}": v for e in effects for f, v in e.neutral.items()})

    def change(self, numbers: dict[str, float]) -> float:
        """By how much the currents change with other numbers, RMS [A]."""
        other = self._driven([r.current for r in self._simulated(numbers)])
        return _rms(self._driven([r.current for r in self.ours]) - other)

    def left_out(self, numbers: dict[str, float]) -> str:
        """The error of numbers that a target takes instead, in words."""
        whole, size = _rms(self._driven([t.current for t in self.trials])), self.change(numbers)
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


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _coupled(heldout: ArmHeldout, folder: Path) -> list[np.ndarray]:
    """The loop beside plain MuJoCo, under the controller of the trials."""
    given: dict[str, np.ndarray] = {}
    for k, t in enumerate(heldout.trials):
        said = t.schedule
        given |= {f"mode_{k}": said.mode, f"limit_{k}": said.current_limit}
        given |= {f"reference_{k}": said.reference, f"rate_{k}": said.reference_rate}
        given[f"angle_{k}"] = np.array(t.first_angle)
    about = {"name": c_name(heldout.model.name), "trials": len(heldout.trials)}
    made = played_alone("arm", folder, about, given)
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
    made = played_alone("arm_led", folder, about, given)
    return [made[f"current_{k}"] for k in range(len(heldout.trials))]


def _motors(player: str) -> Callable[[ArmHeldout, Path], list[np.ndarray]]:
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
            made = played_alone(player, folder, about, given)
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


def played_arm(model: CorrectedArm, player: str, folder: Path) -> Errors:
    """The errors of an arm that was exported to a folder, on the trials kept aside."""
    heldout = ArmHeldout(model)
    return heldout.errors(PLAYED[player](heldout, folder))


def arm_left_out(model: CorrectedArm, instead: dict[str, dict[str, float]]) -> dict[str, str]:
    """The error of what a target leaves out, in words: name -> numbers that it takes instead."""
    try:
        heldout = ArmHeldout(model)
    except ExportError:
        unknown = "of unknown size, as no trial of the arm was kept aside"
        return dict.fromkeys(instead, unknown)
    return {name: heldout.left_out(numbers) for name, numbers in instead.items()}
