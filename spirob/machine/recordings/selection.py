"""Which logs take part: filtered alike, none of them twice, one divided where there is one."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import TypeVar

import numpy as np

from spirob.errors import ConfigError, DataError, NothingLeft
from spirob.machine.recordings.checks import EDGE
from spirob.machine.recordings.recording import CLOSE, FEWEST, LEAST, Piece, Recording

Log = TypeVar("Log")
ROOM = 2.0 * EDGE + (FEWEST + 2) / (2.0 * CLOSE)  # periods of a cutoff: both ends, and what counts


def filtered_alike(
    read: Callable[[Log, float | None], Recording], train: Sequence[Log], test: Sequence[Log]
) -> tuple[list[Recording], list[Recording]]:
    """The trials for training and those held out, by one cutoff (`_common`).

    read  makes a recording of a log, with the cutoff [Hz] that is given

    Raises DataError where no training log is left, and what `read` raises but NothingLeft.
    """
    own, said, _ = _left(read, train, None)
    if not own:
        raise DataError("; ".join(said) or "a diagnosis needs at least one training log")
    cutoff = _common(own)
    held, more, short = _left(read, test, cutoff)
    if short and _common(own, short) > cutoff:
        cutoff = _common(own, short)
        held, more, short = _left(read, test, cutoff)
    trials = own
    if any(trial.cutoff != cutoff for trial in own):
        trials, said, shorter = _left(read, train, cutoff)
        short = [*shorter, *short]
    said = [*said, *more, *(_too_short(trial, cutoff) for trial in short)]
    trials[0].said.extend(f"{text}; the log is left out." for text in said)
    return trials, held


def _common(trials: Sequence[Recording], held: Sequence[Recording] = ()) -> float:
    """The lowest cutoff of the trials that most of each one's motion passes.

    Or what leaves the shortest log room; at most the highest.  Room for the longest trial it leaves
    in any case.

    held  further ones that need room
    """
    every = [*trials, *held]
    highest = max([*(trial.cutoff for trial in every), min(_least(trial) for trial in trials)])
    lowest = max(min(trial.cutoff for trial in trials), *(trial.least for trial in trials))
    return min(max(lowest, *(_least(trial) for trial in every)), highest)


def _least(trial: Recording) -> float:
    """The cutoff [Hz] that leaves just enough of the longest piece of a trial."""
    return ROOM / (trial.period * max(len(piece.q) for piece in trial.pieces))


def _too_short(trial: Recording, cutoff: float) -> str:
    return (
        f"{trial.name}: too short for the filter of the other logs, of {cutoff:.3g} Hz; "
        f"{ROOM:.2g} periods of it are {ROOM / cutoff:.3g} s"
    )


def _left(
    read: Callable[[Log, float | None], Recording], logs: Sequence[Log], cutoff: float | None
) -> tuple[list[Recording], list[str], list[Recording]]:
    """The recordings of which something is left, and what is said of the others.

    Also, by their own cutoffs, those that are too short for this one.
    """
    found: list[Recording] = []
    said: list[str] = []
    short: list[Recording] = []
    for log in logs:
        try:
            trial, fits = _with_room(read, log, cutoff)
            (found if fits else short).append(trial)
        except NothingLeft as error:
            said.append(str(error))
    return found, said, short


def _with_room(
    read: Callable[[Log, float | None], Recording], log: Log, cutoff: float | None
) -> tuple[Recording, bool]:
    """A recording, and whether by this cutoff; else by its own, where it is too short for this."""
    try:
        return read(log, cutoff), True
    except DataError:
        if cutoff is None:
            raise
        trial = read(log, None)
        if cutoff >= _least(trial):
            raise
        return trial, False


def each_once(
    logs: Sequence[tuple[str, Mapping[str, np.ndarray]]], compared: Sequence[str]
) -> None:
    """Raise ConfigError where the rows of one log are another's, or a stretch of them.

    logs      name and columns of each;  compared  the columns that say what the machine did: time
              may begin anew in a copy
    """
    rows = [(name, _rows(columns, compared)) for name, columns in logs]
    for one, other in combinations(rows, 2):
        (part, few), (whole, many) = (one, other) if len(one[1]) < len(other[1]) else (other, one)
        if few and few in many:
            said = "holds the rows of" if len(few) == len(many) else "is a part of"
            raise ConfigError(f"{part}: {said} {whole}; a log is fitted or held out, once")


def _rows(columns: Mapping[str, np.ndarray], compared: Sequence[str]) -> bytes:
    """The rows as bytes, none where a column is absent or nothing moves."""
    if any(name not in columns for name in compared):
        return b""
    table = np.column_stack([np.asarray(columns[name], float) for name in compared])
    return b"" if np.all(table == table[:1]) else table.tobytes()


KEPT = 0.3  # of the log, and of its way, is kept aside, as one block at its end
MOST = 0.5  # of the log, at most
ASIDE = f"The last {KEPT:.0%} of every log, and of its motion, was kept aside."
SHORTEST_DIVIDED = 4.0  # s of a log that is to be divided


def split(
    train: list[Recording], test: list[Recording]
) -> tuple[list[Recording], list[Recording], list[str]]:
    """The logs as they are, or the end of each training log as held-out block.

    Raises NothingLeft where nothing can be held out.
    """
    if test:
        return train, test, []
    said = (
        f"No held-out log was given: {ASIDE} The rest is judged on blocks. Blocks of one trial "
        "share its start, load and temperature."
    )
    kept, held, more = ends_aside(train)
    return kept, held, [said, *more]


def ends_aside(logs: list[Recording]) -> tuple[list[Recording], list[Recording], list[str]]:
    """Each log but for its end, these ends, and what is said of logs that are too short for it.

    These are fitted as a whole.  An end that is one hold tells next to nothing, so it holds a part
    of the motion, too.  Raises NothingLeft where all of them are too short.
    """
    kept, held, said = [], [], []
    for recording in logs:
        long = sum(len(p.q) for p in recording.pieces)
        needed = round(SHORTEST_DIVIDED / recording.period)
        late = _late(recording)
        begin = _part(recording, recording.name, ~late)
        end = _part(recording, f"{recording.name} (end)", late)
        if long >= needed and begin.pieces and end.pieces:
            kept.append(begin)
            held.append(end)
        else:
            kept.append(recording)
            said.append(f"{recording.name}: too short to be divided; fitted as a whole.")
    if not held:
        names = ", ".join(r.name for r in logs)
        raise NothingLeft(
            f"{names}: too short to hold an end out: {SHORTEST_DIVIDED:g} s with "
            f"{round(LEAST / KEPT)} rows that are compared are needed, or a log to hold out"
        )
    return kept, held, said


def _late(recording: Recording) -> np.ndarray:
    """Rows of all pieces that are kept aside, a mask (n,): the last of them, and of the way."""
    used = np.concatenate([p.use for p in recording.pieces])
    speed = np.abs(np.concatenate([p.v for p in recording.pieces]))
    counted, way = np.cumsum(used), np.cumsum(np.where(used, speed, 0.0))
    half = counted > (1.0 - MOST) * counted[-1]
    return np.asarray(
        half & ((counted > (1.0 - KEPT) * counted[-1]) | (way > (1.0 - KEPT) * way[-1]))
    )


MOST_ROWS = 50_000  # of a role: a search keeps a thousand residuals and states in half a gigabyte
STRETCH = 10.0  # s of a log that are used in a row


def in_stretches(logs: list[Recording]) -> tuple[list[Recording], list[str]]:
    """The logs with no more rows than can be kept, and what is said of that.

    Of very long logs one stretch of so many is used, evenly spread over what is compared.
    """
    whole = logs
    logs = [replace(r, pieces=[_compared(p) for p in r.pieces]) for r in logs]
    rows = sum(len(p.q) for r in logs for p in r.pieces)
    among = -(-rows // MOST_ROWS)
    if among <= 1:
        return whole, []
    found = []
    for recording in logs:
        long = round(STRETCH / recording.period)
        pieces = [
            piece.part(slice(k, k + long))
            for piece in recording.pieces
            for k in range(0, len(piece.q), among * long)
        ]
        found.append(replace(recording, pieces=recording.worth(pieces)))
    names = ", ".join(dict.fromkeys(r.log for r in logs))
    said = f"{names}: {rows} rows are more than a search needs; {STRETCH:g} s of each "
    return [r for r in found if r.pieces], [f"{said}{among * STRETCH:g} s are used."]


def _compared(piece: Piece) -> Piece:
    """The piece from the first to the last of its rows that are compared."""
    used = np.flatnonzero(piece.use)
    return piece.part(slice(int(used[0]), int(used[-1]) + 1)) if len(used) else piece


def _part(recording: Recording, name: str, rows: np.ndarray) -> Recording:
    """The recording with some rows compared only, a mask over all pieces in a row."""
    ends = np.cumsum([len(p.q) for p in recording.pieces])
    masks = np.split(rows, ends[:-1])
    pieces = [replace(p, use=p.use & m) for p, m in zip(recording.pieces, masks, strict=True)]
    return replace(recording, name=name, pieces=recording.worth(pieces))
