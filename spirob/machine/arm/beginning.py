"""Where a log of the arm begins, at rest, under which currents, with the rotors where in a turn;
and how far it may go from there."""

import numpy as np

from spirob.errors import DataError
from spirob.machine.arm.description import ArmFile
from spirob.machine.rig import ANGLES
from spirob.plant.holes import stroke

MOVING = 0.2  # of the fast part of the motion: so fast an arm does not stand
SURE = 3.0  # deviations of a mean, beyond which it is another
BEGUN = 50  # cycles of 1 ms at the beginning, in which the arm has to stand
FIRST = 3  # samples at least that say whether there is a current before any change of it
SPARE = 1.25  # of the stroke: holes, drums and where the arm begins are known less well than that
APART = 5  # samples, between which noise has nothing in common at 200 Hz and more


def at_rest(name: str, first: np.ndarray, velocity: np.ndarray) -> None:
    """Raise DataError where the log begins in the midst of a motion.

    first  velocity of both motors as the log begins;  velocity  of the whole log, (T, 2)
    """
    if np.any(np.abs(first).mean(axis=0) > MOVING * np.quantile(np.abs(velocity), 0.95)):
        raise DataError(f"{name}: it begins in motion; the model plays a log from rest")


def within_stroke(name: str, length: np.ndarray, current: np.ndarray, rig: ArmFile) -> None:
    """Raise DataError, with the time and the column, where an arm cannot be wound in so far.

    length   that both motors have wound in since the log began, at 1 kHz, (T, 2) [m]
    current  of both motors, which bends the arm before the log begins and stretches tendons [A]
    """
    machine, motors = rig.machine(), rig.motors().values()
    winch, motor = machine.winch, machine.motor
    pull = winch.gear_ratio * motor.torque_constant * np.abs(current).max() / winch.radius
    whole = stroke(machine.geometry.arm())
    ways = 1.0 if held(current[:BEGUN]) is None else 2.0  # from straight, or from the other side
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


def held(first: np.ndarray) -> np.ndarray | None:
    """Currents under which the arm rests as a log begins (2,) [A]; None where there are none.

    first  both currents as the log begins, (n, 2)
    """
    levels = np.array([first_level(current) for current in first.T])
    return levels if levels.any() else None


def first_level(current: np.ndarray) -> float:
    """Where a current, (n,), begins: 0 where its first samples cannot be told from their noise.

    It may be asked to change at once.  So the mean reaches only as far as it agrees, within what
    the noise allows, with the means of fewer samples.
    """
    bend = current[2 * APART :] - 2.0 * current[APART:-APART] + current[: -2 * APART]  # no ramp
    noise = 1.4826 * np.median(np.abs(bend - np.median(bend))) / np.sqrt(6)
    counts = np.arange(1, len(current) + 1)
    means, widths = np.cumsum(current) / counts, SURE * noise / np.sqrt(counts)
    agree = np.maximum.accumulate(means - widths) <= np.minimum.accumulate(means + widths)
    last = len(agree) - 1 if agree.all() else int(np.argmin(agree)) - 1
    sure = last >= FIRST - 1 and all(abs(means[k]) > widths[k] for k in (FIRST - 1, last))
    return float(means[last]) if sure else 0.0


def first_angles(length: np.ndarray, rig: ArmFile) -> tuple[float, ...]:
    """Where in a turn the rotors stand [rad], from what the log calls their angles; else 0.

    length  wound in, as the log counts it where it begins [m], (2,)
    """
    winch = rig.machine().winch
    turn = winch.gear_ratio / winch.radius
    motors = zip(length, rig.motors().values(), strict=True)
    return tuple(float(x) * turn if of.position.unit in ANGLES else 0.0 for x, of in motors)
