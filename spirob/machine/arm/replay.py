"""A log of the arm as a trial that the model can play again.

How the arm was commanded is not in such a log, and need not be: the motor that does the work gets
the current that was measured and what holds the model to the motion that was measured, the other
one the measured current alone.  What is added is the model's own error, in ampere (`description`);
beside it the length that the other motor winds in is compared.  Of a motor whose command is in the
log, that is given.

Held-out trials are kept as plain data beside a diagnosis (`table_of`, `lasting`), and are trials
`again` from it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from spirob.control import CURRENT, DISPLACEMENT, MODES, Schedule
from spirob.errors import DataError, MissingChannel
from spirob.identify.measurement import MEASURED, Measurement
from spirob.logs.readers import Table
from spirob.machine.arm.description import ArmFile
from spirob.machine.arm.rest import BEGUN, held, rests
from spirob.machine.arm.rows import usable
from spirob.machine.description.rig import ANGLES, Column
from spirob.machine.recordings.filtering import derivative, smooth
from spirob.machine.recordings.grids import Logged, even_grids
from spirob.plant.tendon import stroke
from spirob.robot import MOTORS, Scene

MOVING = 0.2  # of the fast part of the motion: so fast an arm does not stand
LITTLE = 0.01  # of the stroke, within which tendons and gears yield as much as an arm bends
SPARE = 1.25  # of the stroke: holes, drums and where the arm begins are known less well than that
PLAYED = ("reference", "reference_rate")
NAMES = {number: name for name, number in MODES.items()}


def at_rest(name: str, first: np.ndarray, velocity: np.ndarray) -> None:
    """Raise DataError where the log begins in the midst of a motion.

    first  velocity of both motors as the log begins;  velocity  of the whole log, (T, 2)
    """
    if np.any(np.abs(first).mean(axis=0) > MOVING * np.quantile(np.abs(velocity), 0.95)):
        raise DataError(f"{name}: it begins in motion; the model plays a log from rest")


def within_stroke(
    name: str,
    length: np.ndarray,
    current: np.ndarray,
    begun: np.ndarray | None,
    rig: ArmFile,
) -> None:
    """Raise DataError, with the time and the column, where an arm cannot be wound in so far.

    length   that both motors have wound in since the log began, at 1 kHz, (T, 2) [m]
    current  of both motors, which stretches tendons [A];  begun  as in `rest`
    """
    machine, motors = rig.machine(), rig.motors().values()
    winch, motor = machine.winch, machine.motor
    pull = winch.gear_ratio * motor.torque_constant * np.abs(current).max() / winch.radius
    whole = stroke(machine.geometry.arm())
    ways = 1.0 if begun is None else 2.0  # from straight, or from the other side
    most = SPARE * ways * whole + pull / machine.tendon.stiffness
    for wound, columns in zip(length.T, motors, strict=True):
        if wound.max() > most:
            k = int(np.argmax(wound > most))
            raise DataError(
                f"{name}: '{columns.position.column}' has wound in {1e3 * wound[k]:.0f} mm "
                f"{1e-3 * k:.2f} s after the log begins, and {1e3 * wound.max():.0f} mm at most, "
                f"but the arm's stroke is {1e3 * whole:.0f} mm: a unit, the gear, the drum or the "
                "geometry is wrong"
            )


def barely_moves(trials: Sequence[Measurement], rig: ArmFile) -> list[str]:
    """That the arm moves next to nothing in any log, where that is so."""
    whole = stroke(rig.machine().geometry.arm())
    most = max(float(np.ptp(trial.displacement, axis=0).max()) for trial in trials)
    if most > LITTLE * whole:
        return []
    return [
        f"The motors wind in {1e3 * most:.2g} mm at most, of a stroke of {1e3 * whole:.0f} mm: is "
        "the unit or the factor of a position another? So little shows them, and hardly the arm."
    ]


def first_angles(length: np.ndarray, rig: ArmFile) -> tuple[float, ...]:
    """Where in a turn the rotors stand [rad], from what the log calls their angles; else 0.

    length  wound in, as the log counts it where it begins [m], (2,)
    """
    winch = rig.machine().winch
    turn = winch.gear_ratio / winch.radius
    motors = zip(length, rig.motors().values(), strict=True)
    return tuple(float(x) * turn if of.position.unit in ANGLES else 0.0 for x, of in motors)


CYCLE = 1e-3  # s, of the model
ROOM = 2.0  # times the largest current: the model's command never reaches its limit


def arm_trial(table: Table, rig: ArmFile, role: str) -> tuple[Measurement, list[str]]:
    """A log as a trial of the model, and sentences about what was repaired.

    Raises MissingChannel and DataError in a sentence that names the file.
    """
    for column in rig.columns():
        table.column(column)
    time = rig.time.told(table.name, table.units)
    name, said = table.name, list(table.said)
    values, every = _regular(name, table.columns, rig.model_copy(update={"time": time}), said)
    length, current = (_both(values, kind) for kind in ("position", "effort"))
    motion = np.column_stack([smooth(x, rig.filter.cutoff, CYCLE) for x in length.T])
    velocity = np.column_stack([derivative(x, CYCLE) for x in motion.T])
    begin = slice(0, BEGUN)
    zero = np.median(length[begin], axis=0)
    at_rest(name, velocity[begin], velocity)
    _currents(name, current, rig, said)
    begun, unsure = held(current[: rests(velocity) : every])
    within_stroke(name, length - zero, current, begun, rig)
    moves = int(np.argmax(np.std(current, axis=0)))
    said.append(f"{name}: the {MOTORS[moves]} motor does the work; it follows its measured motion.")
    given = _given(values, rig)
    schedule = Schedule(
        mode=np.array([DISPLACEMENT if m == moves else CURRENT for m in range(len(MOTORS))]),
        reference=np.where(np.arange(len(MOTORS)) == moves, motion - zero, given),
        reference_rate=velocity + given / rig.machine().gains.velocity,
        current_limit=np.full(len(MOTORS), ROOM * float(np.abs(current).max())),
        held=begun,
    )
    trial = Measurement(
        name,
        role,
        current,
        length - zero,
        velocity,
        schedule,
        Scene(),
        first_angle=first_angles(zero, rig),
        use=usable(name, current, velocity, moves, rig, said),
        every=every,
        unsure=unsure,
    )
    return trial, said


def _both(values: Mapping[str, np.ndarray], kind: str) -> np.ndarray:
    return np.column_stack([values[f"{motor}.{kind}"] for motor in MOTORS])


def _given(values: Mapping[str, np.ndarray], rig: ArmFile) -> np.ndarray:
    """What each motor is given from cycle to cycle [A], (T, 2).

    A drive reports the current of the cycle that ends; a command is for the one that begins.
    """
    found = []
    for motor, columns in rig.motors().items():
        reported = values[f"{motor}.effort"]
        coming = np.append(reported[1:], reported[-1])
        found.append(coming if columns.command is None else values[f"{motor}.command"])
    return np.column_stack(found)


def _regular(
    name: str, columns: Mapping[str, np.ndarray], rig: ArmFile, said: list[str]
) -> tuple[dict[str, np.ndarray], int]:
    """All signals in SI on the model's clock, positions in metres wound in; cycles a sample."""
    wanted = {
        f"{m}.{k}": column
        for m, of in rig.motors().items()
        for k in ("position", "effort", "command")
        if (column := getattr(of, k)) is not None
    }
    for column in (rig.time, *wanted.values()):
        if column.column not in columns:
            raise MissingChannel(name, column.column, list(columns))
    cells = {key: np.asarray(columns[c.column], float) for key, c in wanted.items()}
    scaled = {key: _scaled(c, columns) for key, c in wanted.items()}
    stamps = np.asarray(columns[rig.time.column], float)
    _, grids = even_grids(Logged(name, rig.time, stamps, wanted, cells, scaled), said)
    if len(grids) != 1:
        broken = next(text for text in reversed(said) if "cut there" in text)
        raise DataError(
            f"{broken.removesuffix('.')}, but the model plays a log from its beginning to its end; "
            "give whole ones"
        )
    even = np.arange(grids[0]["time"][0], grids[0]["time"][-1], CYCLE)
    values = {}
    for key in wanted:
        of = rig.motors()[key.partition(".")[0]]
        si = of.metres(rig.machine()) if key.endswith("position") else of.amperes(wanted[key])
        values[key] = si * np.interp(even, grids[0]["time"], grids[0][key])
    period = float(np.median(np.diff(grids[0]["time"])))
    return values, max(1, round(period / CYCLE))


def _scaled(column: Column, columns: Mapping[str, np.ndarray]) -> np.ndarray:
    return column.factor * (np.asarray(columns[column.column], float) - column.zero)


def _currents(name: str, current: np.ndarray, rig: ArmFile, said: list[str]) -> None:
    """A constant current may have been commanded, and is said; raise where both are constant."""
    stuck = [m for m in range(len(MOTORS)) if np.ptp(current[:, m]) == 0.0]
    columns = [c.effort.column for c in rig.motors().values()]
    if len(stuck) == len(MOTORS):
        both = "' and '".join(columns)
        raise DataError(f"{name}: '{both}' are constant; nothing can be told from them")
    said += [
        f"{name}: '{columns[m]}' is constant at {current[0, m]:.3g} A, taken as commanded."
        for m in stuck
    ]


def table_of(trials: Sequence[Measurement]) -> pd.DataFrame:
    """The table of `heldout.parquet`, a row for each cycle.

    It holds the trial's number, whether the cycle is compared, and of each motor its signals and
    what holds the model to the log.
    """
    parts = []
    for k, trial in enumerate(trials):
        own = {"trial": k, "use": True if trial.use is None else trial.use}
        both = {name: getattr(trial, name) for name in MEASURED}
        both |= {name: getattr(trial.schedule, name) for name in PLAYED}
        pairs = {
            f"{n} of {motor}": x[:, m] for n, x in both.items() for m, motor in enumerate(MOTORS)
        }
        parts.append(pd.DataFrame(pairs).assign(**own))
    return pd.concat(parts, ignore_index=True)


def lasting(trials: Sequence[Measurement]) -> list[dict[str, Any]]:
    """What stays the same in each trial."""
    return [
        {
            "name": t.name,
            "mode": [NAMES[int(mode)] for mode in t.schedule.mode],
            "current_limit": t.schedule.current_limit.tolist(),
            "held": None if t.schedule.held is None else t.schedule.held.tolist(),
            "first_angle": list(t.first_angle),
        }
        for t in trials
    ]


def again(table: pd.DataFrame, known: Sequence[Mapping[str, Any]]) -> list[Measurement]:
    """The trials of a table; raises KeyError, TypeError or ValueError where something is off."""
    found = []
    for k, about in enumerate(known):
        own = table[table["trial"] == k]
        both = {
            n: own[[f"{n} of {m}" for m in MOTORS]].to_numpy(float) for n in (*MEASURED, *PLAYED)
        }
        if not len(own) or not all(np.isfinite(x).all() for x in both.values()):
            raise ValueError(f"trial {k} has no finite rows")
        reference, rate = (both[name] for name in PLAYED)
        schedule = Schedule(
            np.array([MODES[mode] for mode in about["mode"]]),
            reference,
            rate,
            np.array(about["current_limit"], float),
            None if about["held"] is None else np.array(about["held"], float),
        )
        first = tuple(map(float, about["first_angle"]))
        use = own["use"].to_numpy(bool)
        current, displacement, velocity = (both[n] for n in MEASURED)
        signals = current, displacement, velocity
        trial = Measurement(str(about["name"]), "heldout", *signals, schedule, Scene(), first)
        found.append(replace(trial, use=use))
    return found
