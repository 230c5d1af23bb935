"""What a measured speed has to do with the derivative of a measured position."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spirob.machine.recordings.filtering import acceleration_noise, rates, smooth

ALIKE = 0.8  # correlation below which it is no derivative of the position
LATE = 0.1  # s by which it may be late, and is looked for
SURELY_SHIFTED = 0.5  # of what is missed: a shift that takes less is none
OWN = np.sqrt(2.0)  # times the noise of a derivative: half of a speed's is then its own
NEAR = 0.03  # of 1: a scale this close is a right one


@dataclass(frozen=True)
class Agreement:
    """How a speed follows from the motion: scale times it, `late` samples later.

    alike  correlation when it is scaled and shifted
    """

    scale: float
    late: float
    alike: float


def agreement(
    given: Sequence[np.ndarray], derived: Sequence[np.ndarray], period: float
) -> Agreement | None:
    """What a given speed has to do with the derived one, over all pieces, equal lengths each.

    None where nothing moves, or it is no derivative of the position within a tenth of a second.
    """
    most = min(max(2, round(LATE / period)), min(map(len, given)) // 4)
    shifts = np.arange(-most, most + 1)
    alike = np.array([_alike(given, derived, int(k)) for k in shifts])
    best, late = int(np.argmax(np.abs(alike))), 0.0
    if 1 - alike[best] ** 2 >= SURELY_SHIFTED * (1 - alike[most] ** 2):
        best = most
    elif 0 < best < len(shifts) - 1:
        left, middle, right = np.abs(alike[best - 1 : best + 2])
        late = float(shifts[best] + 0.5 * (left - right) / (left - 2 * middle + right))
    else:
        return None
    at = alike[best]
    if not abs(at) >= ALIKE:
        return None
    one, two, both = _powers(given, derived, int(shifts[best]))
    low, high = both / two, one / both  # noise in the derivative, in the sensor
    sure = low > 0 and low * (1 - NEAR) <= 1.0 <= high * (1 + NEAR)
    return Agreement(1.0 if sure else float(np.sign(at) * np.sqrt(low * high)), late, float(at))


def measured(
    title: str,
    given: Sequence[np.ndarray],
    places: Sequence[np.ndarray],
    cutoff: float,
    period: float,
    said: list[str],
) -> list[np.ndarray]:
    """Given speeds of all pieces, with the scale and on the time of their positions.

    None where they are no derivative of the positions, or noisier than it.  What is found goes to
    `said`, of a column that is called by its `title`.
    """
    derived = [rates(smooth(place, cutoff, period), period)[0] for place in places]
    found = agreement([smooth(v, cutoff, period) for v in given], derived, period)
    if found is None:
        said.append(f"{title} is no derivative of the position and was left out.")
        return []
    noise = acceleration_noise(np.concatenate(given) / found.scale, 1, cutoff, period)
    if noise > OWN * acceleration_noise(places[0], 2, cutoff, period):
        off = "" if found.scale == 1.0 else f", which it is {found.scale:.2g} times,"
        said.append(
            f"{title} is noisier than the derivative of the position{off} and was left out."
        )
        return []
    if found.scale != 1.0:
        said.append(f"{title} is {found.scale:.3g} times the derivative of the position; scaled.")
    if found.late:
        when = "late" if found.late > 0 else "early"
        said.append(f"{title} is {1e3 * abs(found.late) * period:.3g} ms {when}; aligned.")
    return [shifted(values, found.late) / found.scale for values in given]


def shifted(values: np.ndarray, samples: float) -> np.ndarray:
    """A signal as it is so many samples later, same length; its end is held."""
    index = np.arange(len(values))
    return np.interp(index + samples, index, values)


def _powers(
    given: Sequence[np.ndarray], derived: Sequence[np.ndarray], shift: int
) -> tuple[float, float, float]:
    """Mean squares of both, and of their product, `given` taken so many samples later."""
    pairs = [(a[max(shift, 0) :], b[max(-shift, 0) :]) for a, b in zip(given, derived, strict=True)]
    one = np.concatenate([a[: len(b)] for a, b in pairs])
    two = np.concatenate([b[: len(a)] for a, b in pairs])
    return float(np.mean(one**2)), float(np.mean(two**2)), float(np.mean(one * two))


def _alike(given: Sequence[np.ndarray], derived: Sequence[np.ndarray], shift: int) -> float:
    one, two, both = _powers(given, derived, shift)
    return both / float(np.sqrt(one * two)) if one > 0 and two > 0 else 0.0
