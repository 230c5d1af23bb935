"""Rows in which a drive saturates, by its limit, or by where what it reports stays.

A command is what the drive was asked for, and had to give: at the largest of it nothing is cut off
that the log does not hold.  What a drive reports, or a sensor, may end where it stays; that is one
value in all logs of a rig.  Where an effort never passes through zero, to stay there is rest.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spirob.logs.readers import Table
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings import checks

FULL = 0.98  # of the drive's limit counts as saturated
# Of the rows at the ends, or of the others in runs of one value: that is the excitation, not what
# cuts it off
RELAY = 0.5
TOP = 0.2  # of a top, that the next steps last
TWO_STEPS = 2.0  # of a staircase may go to one value in a row, at its turn
STUCK = 5  # equal extreme values in a row are a limit that nobody declared
SAME = 1e-9  # of a value: what means over equal ones differ by


@dataclass(frozen=True)
class Ends:
    """The largest and smallest efforts of logs at which a drive may saturate.

    steps  whether they are the outermost steps of what moves the axis, and no saturation
    """

    values: tuple[float, ...]
    steps: bool


def ends_of(efforts: Sequence[np.ndarray]) -> Ends:
    """The ends of efforts, (n,) each.

    Where most rows lie at them, they are what moves the axis: a relay.  Where most of the others
    stay at one value as well, they are the outermost steps of a staircase.  Rest is neither.
    """
    ends = max(e.max() for e in efforts), min(e.min() for e in efforts)
    values = tuple(float(end) for end in ends if end != 0.0)
    if len(values) < len(ends):
        efforts = [effort for effort in (e[e != 0.0] for e in efforts) if len(effort)]
    if not efforts:
        return Ends((), False)
    full = [_stuck(effort, values) for effort in efforts]
    steps = float(np.mean(np.concatenate(full))) > RELAY or _is_staircase(efforts, full)
    return Ends(values, steps)


def ends_of_logs(rig: RigFile, logs: Sequence[Table]) -> Ends | None:
    """The ends of the efforts of all logs of a rig; None where they tell nothing."""
    name, efforts = rig.effort.column, []
    for log in logs if _may_end(rig) else ():
        cells = checks.signed("", name, np.asarray(log.column(name), float), [])
        values = rig.effort.scale * rig.effort.factor * (cells - rig.effort.zero)
        values = checks.without_sentinels("", name, values, cells, [])
        values = checks.without_outliers("", name, values, 1.0 / checks.FEW, [])
        efforts.append(values[np.isfinite(values)])
    efforts = [effort for effort in efforts if len(effort)]
    return ends_of(efforts) if efforts else None


def saturated(
    where: str, efforts: Sequence[np.ndarray], rig: RigFile, ends: Ends | None, said: list[str]
) -> list[np.ndarray]:
    """Rows of each piece of a log in which the drive saturates, by its limit or by these ends.

    ends  of all logs of the rig; None: of this one
    """
    if rig.effort.limit is not None:
        limit = rig.effort.limit * rig.effort.scale
        return [np.abs(effort) >= FULL * limit for effort in efforts]
    if not _may_end(rig):
        return [np.zeros(len(effort), bool) for effort in efforts]
    ends = ends or ends_of(efforts)
    full = [_stuck(effort, ends.values) for effort in efforts]
    if not ends.steps:
        return [_without_tops(*pair) for pair in zip(efforts, full, strict=True)]
    if (shown := f"{float(np.mean(np.concatenate(full))):.0%}") != "0%":
        said.append(
            f"{where}: {shown} of the efforts are the largest or smallest of the logs: taken as "
            "steps of the command, not as a drive that saturates; give `effort.limit` where it "
            "does."
        )
    return [np.zeros_like(rows) for rows in full]


def _may_end(rig: RigFile) -> bool:
    """Whether the effort was measured, and its limit is not known."""
    asked = rig.effort.origin == "command" or rig.effort.source == "control"
    return rig.effort.limit is None and not asked


def _is_staircase(efforts: Sequence[np.ndarray], full: Sequence[np.ndarray]) -> bool:
    """Whether the rows that are not full lie in runs of one value, about as long as those that are.

    A coarse effort, or one of a slow controller, stays at its limit for longer than at any value.
    """
    runs = [_runs(effort) for effort in efforts]
    lengths = np.concatenate([length for _, length in runs])
    ends = np.concatenate([f[start] for f, (start, _) in zip(full, runs, strict=True)])
    ending, inner = lengths[ends], lengths[~ends]
    steady = inner[inner >= STUCK]
    if not len(ending) or steady.sum() <= RELAY * inner.sum():
        return False
    return bool(np.median(ending) <= TWO_STEPS * np.median(steady))


def _runs(effort: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First row and length of each run of one value, (k,) each."""
    starts = np.flatnonzero(np.append(True, np.diff(effort) != 0))
    return starts, np.diff(np.append(starts, len(effort)))


def _stuck(effort: np.ndarray, ends: Sequence[float]) -> np.ndarray:
    """Rows (n,) that stay at one of these ends for a while."""
    full = np.zeros(len(effort), bool)
    for extreme in ends:
        same = np.abs(effort - extreme) <= SAME * abs(extreme)
        at = np.concatenate([[0], same.astype(int), [0]])
        edges = np.flatnonzero(np.diff(at))
        for start, stop in zip(edges[::2], edges[1::2], strict=True):
            if stop - start >= STUCK:
                full[start:stop] = True
    return full


def _without_tops(effort: np.ndarray, full: np.ndarray) -> np.ndarray:
    """The full rows (n,) without those that are tops of a curve in coarse steps.

    Of a parabola the next steps last (√2 - 1)/2 of the top at least, of a clipped curve far less.
    """
    kept = full.copy()
    edges = np.flatnonzero(np.diff(np.concatenate([[0], full.astype(int), [0]])))
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        long = stop - start
        beside = [effort[max(start - long, 0) : start], effort[stop : stop + long]]
        lasting = [int(_runs(part)[1].max()) for part in beside if len(part)]
        if lasting and min(lasting) >= max(2, TOP * long):
            kept[start:stop] = False
    return kept
