"""A measured trial in the form in which the model can play it again."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spirob.control import CURRENT, Schedule
from spirob.errors import DataError
from spirob.logs.trace import Trace
from spirob.robot import MOTORS, Scene, scene_from

MEASURED = ("current", "displacement", "velocity")


@dataclass(frozen=True)
class Measurement:
    """Signals of one trial, (T, 2) for the left and right motor, and what was played.

    current [A], displacement [m], velocity [m/s] as the drives reported them, raw
    first_angle  of the rotors when the trial began [rad], where the log tells
    temperature  of the windings [°C], (T, 2), where the log tells
    use          cycles that are compared, (T,); None: all.  All are played
    every        cycles from one logged sample to the next; those between are interpolated
    unsure       deviation of what the schedule says the arm is held by, (2,) [A]; None: none
    weight       of what is compared in each cycle, over that of others, (T,); None: all alike
    """

    name: str
    role: str
    current: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    schedule: Schedule
    scene: Scene
    first_angle: tuple[float, ...] = (0.0, 0.0)
    temperature: np.ndarray | None = None
    use: np.ndarray | None = None
    weight: np.ndarray | None = None
    every: int = 1
    unsure: np.ndarray | None = None

    @property
    def seconds(self) -> np.ndarray:
        """Time since the trial began [s]."""
        return np.arange(len(self.current)) * 1e-3

    def until(self, end: int) -> "Measurement":
        """The first `end` cycles."""
        schedule = replace(
            self.schedule,
            reference=self.schedule.reference[:end],
            reference_rate=self.schedule.reference_rate[:end],
        )
        signals = ("current", "displacement", "velocity", "temperature", "use", "weight")
        whole = {name: getattr(self, name) for name in signals}
        cut: dict[str, Any] = {n: None if x is None else x[:end] for n, x in whole.items()}
        return replace(self, schedule=schedule, **cut)

    @classmethod
    def from_trace(cls, trace: Trace) -> "Measurement":
        """Read the channels that replaying needs; raises MissingChannel or DataError."""
        trace.require(200, "the model")
        wanted = [f"{motor}.{signal}" for motor in MOTORS for signal in MEASURED]
        trace.require_finite(wanted)

        def both(signal: str) -> np.ndarray:
            return np.column_stack([trace[f"{motor}.{signal}"] for motor in MOTORS])

        measured: dict[str, Any] = {name: both(name) for name in MEASURED}
        role = str(trace.meta.get("role", "train"))
        angle: Any = trace.meta.get("first_angle") or {}
        return cls(
            trace.name,
            role,
            **measured,
            schedule=_as_sent(schedule_of(trace), trace),
            scene=scene_of(trace),
            first_angle=tuple(float(angle.get(motor, 0.0)) for motor in MOTORS),
            temperature=_temperature(trace),
        )


def _temperature(trace: Trace) -> np.ndarray | None:
    """Of both windings [°C], (T, 2); None where a drive does not report it throughout."""
    names = [f"{motor}.temperature" for motor in MOTORS]
    if not all(name in trace.signals and np.isfinite(trace[name]).all() for name in names):
        return None
    return np.column_stack([trace[name] for name in names])


def _as_sent(schedule: Schedule, trace: Trace) -> Schedule:
    """The schedule with the currents that the frames carried, in counts, where a current is asked.

    A constant current is wrong by up to half a count throughout a trial; on logs of the model
    itself that moved the stiffness by 0.8 of its standard deviation.
    """
    sent = [f"{motor}.command" for motor in MOTORS]
    reference = schedule.reference.copy()
    for m, name in enumerate(sent):
        known = name in trace.signals and np.isfinite(trace[name]).all()
        if schedule.mode[m] == CURRENT and known:
            reference[:, m] = trace[name]
    return replace(schedule, reference=reference)


def schedule_of(trace: Trace) -> Schedule:
    """Mode, references and limits as they were asked, cycle by cycle.

    Raises DataError where the trial's description lacks a motor's current limit.
    """
    trial: Any = trace.meta.get("trial", {})
    try:
        limits = [float(trial["motors"][motor]["current_limit"]) for motor in MOTORS]
    except (KeyError, TypeError, ValueError) as error:
        raise DataError(f"{trace.name}: its description lacks a current_limit: {error}") from error
    return Schedule(
        mode=np.array([int(trace[f"{motor}.mode"][0]) for motor in MOTORS]),
        reference=np.column_stack([trace[f"{motor}.reference"] for motor in MOTORS]),
        reference_rate=np.column_stack([trace[f"{motor}.reference_rate"] for motor in MOTORS]),
        current_limit=np.array(limits),
    )


def scene_of(trace: Trace) -> Scene:
    """What surrounded the arm; raises ConfigError naming the trial and the key."""
    scene: Any = trace.meta.get("scene") or {}
    return scene_from(scene, f"trial '{trace.name}'")
