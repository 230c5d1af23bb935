"""Where the axis stands: dry friction takes any value below its level there.

A law of friction by speed says nothing of a rest, be it a hold of minutes or the moment in which an
axis sticks while its effort turns.  Yet such rows can outnumber the moving ones, and what follows
their effort would be named: friction that grows with load, a dead band, a law of a memory.  So they
are left out before the last filter, which else would carry them into the rows beside them.  Where
their speed tells most of their effort, an axis creeps: that is slow motion, of which friction by
speed says how it turns round.
"""

from dataclasses import replace

import numpy as np
import scipy
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from spirob.machine.recordings.filtering import sensor_noise
from spirob.machine.recordings.recording import MOVES, Recording

TURNS = 2.0  # times as long as a reversal is within the way that a rest spans
COUNT = np.sqrt(12.0)  # deviations of what counting adds
LONGER = (1.0, 2.0, 4.0)  # times: the noise of as many rows as a second holds spans 7 deviations
SMEAR = 0.25  # periods of the cutoff, over which the first filter carries a rest into the motion
LEAST = 0.2  # of the rows have to be left, or
ENOUGH = 2.0  # s of them: else the log is one of holds and is used as it is
TELLS = 0.5  # of the variance of ranks in rests: a speed that tells more is one of friction


def without_rests(
    recordings: list[Recording], rest_speed: float
) -> tuple[list[Recording], list[str]]:
    """The trials without the rows at standstill, and a sentence for each that lost some."""
    kept, said = [], []
    rests = [standing(recording, rest_speed) for recording in recordings]
    if _creeps(recordings, rests, rest_speed):
        return recordings, []
    for recording, stands in zip(recordings, rests, strict=True):
        pieces = [
            replace(p, stands=still) for p, still in zip(recording.pieces, stands, strict=True)
        ]
        pieces = [replace(p, use=p.use & (recording.moving(p) > MOVES)) for p in pieces]
        used, left = (sum(int(p.use.sum()) for p in ps) for ps in (recording.pieces, pieces))
        pieces = recording.worth(pieces)
        if not pieces or left < min(LEAST * used, ENOUGH / recording.period):
            kept.append(recording)
            said.append(f"{recording.name}: the axis stands most of the time.")
            continue
        kept.append(replace(recording, pieces=pieces))
        if left < used:
            said.append(
                f"{recording.name}: {1 - left / used:.1%} of the rows left out, where the axis "
                "stands (rows.standstill: keep would use them)."
            )
    return kept, said


def standing(recording: Recording, rest_speed: float) -> list[np.ndarray]:
    """Rows of each piece at which the axis stands, and those that the first filter mixes with them.

    It stands where its path spans no more, over a window, than the speed of rest makes in it.  The
    window is `TURNS` times as long as a reversal with the acceleration A of the log stays within
    that way, A·w²/8 = v_rest·w, and so long that the way is a count of the sensor; or, for noise
    that is more than its counts, a few times longer.
    """
    size = float(np.sqrt(np.mean(np.concatenate([p.a for p in recording.pieces]) ** 2)))
    smear = SMEAR / recording.cutoff
    found = []
    for piece in recording.pieces:
        count = COUNT * sensor_noise(piece.path)
        window = max(TURNS * 8.0 * rest_speed / max(size, 1e-300), count / rest_speed, smear)
        stands = np.zeros(len(piece.path), dtype=bool)
        for times in LONGER:
            stands |= _within(piece.path, times * window, rest_speed, smear, recording.period)
        found.append(stands)
    return found


def _creeps(recordings: list[Recording], rests: list[list[np.ndarray]], rest_speed: float) -> bool:
    """Whether the speed of rows at rest tells most of their effort, by their order in all logs.

    The effort is as logged: a filter mixes the last rows of a wait with the effort that sets in and
    with the motion that it makes, which tell one another.  By their order, as these few rows would
    outweigh the wait.
    """
    rows = [
        np.stack([p.v, p.raw])[:, still & (np.abs(p.v) < rest_speed)]
        for recording, stands in zip(recordings, rests, strict=True)
        for p, still in zip(recording.pieces, stands, strict=True)
    ]
    v, effort = np.concatenate(rows, axis=1)
    if len(v) < 3 or np.ptp(v) == 0.0 or np.ptp(effort) == 0.0:
        return False
    return bool(scipy.stats.spearmanr(v, effort).statistic ** 2 > TELLS)


def _within(
    path: np.ndarray, window: float, rest_speed: float, smear: float, period: float
) -> np.ndarray:
    """Rows of windows [s] in which a path (n,) spans no more than at the speed of rest, widened."""
    rows = max(3, round(window / period)) | 1
    if rows >= len(path):
        return np.zeros(len(path), dtype=bool)
    span = maximum_filter1d(path, rows) - minimum_filter1d(path, rows)
    middle = (span <= rest_speed * rows * period).astype(np.uint8)
    return maximum_filter1d(middle, rows + 2 * round(smear / period), mode="constant") > 0
