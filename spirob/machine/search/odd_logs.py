"""Logs that do not belong together, and what logs do not show for how the axis moves in them.

A cause (a sign, a scale) is said only where mending it makes a log fit the model of the others,
with both figures; otherwise what was found.
"""

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.search.plain_columns import RESISTING, explained, plain_columns

FAMILIAR, STRANGE = 0.7, 0.0  # R² of a log that the model fits, and of one of another machine
MOSTLY = 0.9  # of an effort's square, its level too: of another machine's less is explained
PAIR, FEWEST = 2, 3  # logs that may differ by a unit, and of which one can be told as the odd one
ALIKE = 0.1  # by which a factor between two logs counts as none
HALF = 0.5  # of the squared error that another unit takes: of any other log it takes nothing
UNITS_APART = tuple(f for u in (np.pi / 180, 2 * np.pi, 1e3) for f in (u, 1 / u))
EFFORTS_APART = (1e3, 1e-3)  # amperes among milliamperes
RARE = 0.01  # of the rows in motion: fewer the other way show no friction there


@dataclass(frozen=True)
class OddLogs:
    """Logs that do not belong to the others, by name, and how that shows.

    mended  whether another unit or sign mends it
    """

    names: tuple[str, ...]
    said: str
    mended: bool = False


def strangers(
    problems: Sequence[InverseProblem], residuals: Sequence[np.ndarray]
) -> OddLogs | None:
    """Logs that the others' model does not fit at all, of which the parts are one; None if all fit.

    residuals  of one model on the trials of each problem
    """
    parts: dict[str, list[np.ndarray]] = defaultdict(list)  # log -> effort, modelled, speed
    for problem, residual in zip(problems, residuals, strict=True):
        effort = problem.measured()
        rows = np.stack([effort, effort + residual, problem.signals()["speed"]])
        for log, at in _parts(problem):
            parts[log].append(rows[:, at])
    logs, shared, rest = {}, level(problems), problems[0].rest_speed
    for name, part in parts.items():
        measured, own, speeds = np.concatenate(part, axis=1)
        share = _fitting(measured, own, shared)
        about = _mended(measured, own), way_of(speeds, rest)
        logs[name] = share, *about, _is_strange(share, measured, own)
    strange = {name: log for name, log in logs.items() if log[-1]}
    if not strange or max(share for share, *_ in logs.values()) < FAMILIAR:
        return None
    said = [f"{', '.join(strange)}: what fits the other logs does not fit this at all."]
    said += [f"{name}: {text}." for name, (_, text, *_) in strange.items() if text]
    others = {way for name, (_, _, way, _) in logs.items() if name not in strange}
    if {way for _, _, way, _ in strange.values()} == {-way for way in others} != {0}:
        said.append("It moves a way that no other log does: what these say of friction ends there.")
    return OddLogs(tuple(strange), " ".join(said))


def _is_strange(share: float, measured: np.ndarray, modelled: np.ndarray) -> bool:
    """Whether a log is none of this machine's: neither its changes nor its level are explained.

    share  R² of the log, which says little of one at nearly one effort
    """
    missed = float(np.mean((measured - modelled) ** 2))
    return share < STRANGE and missed > (1.0 - MOSTLY) * float(np.mean(measured**2))


def way_of(speeds: np.ndarray, rest_speed: float) -> int:
    """1 or -1 for a motion of this direction alone; 0 for one of both, and for rest."""
    moving = speeds[np.abs(speeds) > rest_speed]
    ahead = float(np.mean(moving > 0.0)) if len(moving) else 0.5
    return int(ahead > 1.0 - RARE) - int(ahead < RARE)


def ways_apart(train: InverseProblem, heldout: InverseProblem) -> bool:
    """Whether these logs go one way alone, and those the other alone."""
    way, other = _ways(train, heldout)
    return way == -other != 0


def _ways(*problems: InverseProblem) -> list[int]:
    return [way_of(p.signals()["speed"], p.rest_speed) for p in problems]


def one_way(train: InverseProblem, heldout: InverseProblem) -> list[str]:
    """What logs of one direction cannot tell; empty for logs of both."""
    (way,) = _ways(train)
    if not way:
        return []
    ahead = way * heldout.signals()["speed"] / heldout.rest_speed
    goes_back = np.count_nonzero(ahead < -1.0) > RARE * np.count_nonzero(np.abs(ahead) > 1.0)
    said = (
        "The axis moves one way only in the logs that were fitted: in them dry friction is the "
        "same as a constant force, and where the speed changes little viscous friction is, too. "
        "What is fitted, named or taken home holds for this way alone: log the way back, too."
    )
    back = " The logs held out go back, and cannot confirm what no fitted log shows."
    return [said + back if goes_back else said]


def odd_one_out(
    problems: Sequence[InverseProblem], residuals: Sequence[np.ndarray]
) -> OddLogs | None:
    """The one log without which all others fit; None where there is none.

    What fits is inertia, friction and weight, to first order, fitted to the other logs: beside a
    log of another scale, a search finds a law that bends towards it.  So where the model fits all,
    only another unit of the position is told, which nothing else is like.

    residuals  of one model on the trials of each problem
    """
    odd = _apart(problems)
    if odd is None:
        return None
    if said := odd.of_another_unit():
        return OddLogs((odd.name,), said, mended=True)
    measured, modelled = odd.measured, odd.design(1.0) @ odd.found
    mended = _mended(measured, modelled)
    strange = _is_strange(odd.share, measured, modelled) or (odd.share < FAMILIAR and mended)
    left = poorest(problems, residuals) < FAMILIAR
    return OddLogs((odd.name,), odd.said(mended)) if strange and left and odd.logs > PAIR else None


def poorest(problems: Sequence[InverseProblem], residuals: Sequence[np.ndarray]) -> float:
    """Share of the log that a model fits least; `residuals` of the model on each problem."""
    found, shared = 1.0, level(problems)
    for problem, residual in zip(problems, residuals, strict=True):
        measured = problem.measured()
        for start, stop in pairwise(problem.edges):
            own = measured[start:stop]
            found = min(found, _fitting(own, own + residual[start:stop], shared))
    return found


def another_unit(problems: Sequence[InverseProblem]) -> str:
    """The one log whose position or effort has another unit or sign than in all others, or empty.

    No model has to be fitted to see it.
    """
    odd = _apart(problems)
    return odd.of_another_unit() if odd else ""


Log = tuple[np.ndarray, Callable[[float], np.ndarray]]  # its effort, and columns for it


@dataclass(frozen=True)
class _Odd:
    """The log without which the plain columns fit the others best, all of them well.

    found   numbers of the plain columns fitted to the others;  logs  how many there are
    shared  mean of all efforts;  together  share of the poorest log by one set of numbers for all
    """

    name: str
    measured: np.ndarray
    design: Callable[[float], np.ndarray]
    found: np.ndarray
    logs: int
    shared: float
    together: float

    @property
    def share(self) -> float:
        """Of its variance that these numbers explain."""
        return _fitting(self.measured, self.design(1.0) @ self.found, self.shared)

    def of_another_unit(self) -> str:
        """That its position or effort has another unit or sign; empty where neither has."""
        about = self.measured, self.design, self.found, max(self.share, self.together)
        mended = _of_another_unit(*about) or _of_another_sign(*about)
        if mended and self.logs == PAIR:
            mended += " of one of the two logs"
        return self.said(mended) if mended else ""

    def said(self, mended: str) -> str:
        """How little of it the others' numbers explain, and what mends it."""
        said = f"{self.name}: inertia, friction and weight that fit all other logs explain "
        said += f"{max(0.0, self.share):.0%} of its effort's variance"
        return f"{said}; {mended}." if mended else f"{said}."


def _apart(problems: Sequence[InverseProblem]) -> _Odd | None:
    """The log that fits the others least, where these fit one another; None of a single log."""
    parts: dict[str, list[Log]] = defaultdict(list)  # the end of a log may be held out
    for problem in problems:
        for log, rows in _parts(problem):
            parts[log].append((problem.measured()[rows], partial(_design, problem, rows)))
    if len(parts) < PAIR:
        return None
    logs = {name: _joined(part) for name, part in parts.items()}
    fits = {name: _fitted([log for other, log in logs.items() if other != name]) for name in logs}
    name = max(fits, key=lambda one: fits[one][1])
    found, poorest_other = fits[name]
    if poorest_other < FAMILIAR:
        return None
    return _Odd(name, *logs[name], found, len(logs), level(problems), _fitted([*logs.values()])[1])


def _parts(problem: InverseProblem) -> list[tuple[str, slice]]:
    """The log of each trial, and its rows."""
    rows = [slice(*edges) for edges in pairwise(problem.edges)]
    return [(r.log, at) for r, at in zip(problem.recordings, rows, strict=True)]


def _joined(parts: Sequence[Log]) -> Log:
    """The parts of a log as one."""

    def design(times: float) -> np.ndarray:
        return np.concatenate([of(times) for _, of in parts])

    return np.concatenate([effort for effort, _ in parts]), design


def _fitted(logs: Sequence[Log]) -> tuple[np.ndarray, float]:
    """Numbers of the plain columns fitted to logs, (k,), and the poorest log's R²."""
    whole = np.concatenate([design(1.0) for _, design in logs])
    found = np.linalg.lstsq(whole, np.concatenate([effort for effort, _ in logs]), rcond=None)[0]
    return found, min(explained(effort, design(1.0) @ found) for effort, design in logs)


def _design(problem: InverseProblem, rows: slice, times: float) -> np.ndarray:
    """The plain columns of some rows, (n, k), with the motion so many times as large."""
    return np.column_stack(plain_columns(problem, times))[rows]


def _of_another_unit(
    measured: np.ndarray, design: Callable[[float], np.ndarray], found: np.ndarray, share: float
) -> str:
    """Which unit of its position or effort makes a log fit the others' numbers; empty for none.

    Not of its position where another force, payload or zero explains as much.

    share  that they, or one set of numbers for all logs, explain as it is logged
    """
    own = design(1.0)
    by_unit = {("position", t): explained(measured, design(t) @ found) for t in UNITS_APART}
    by_unit |= {("effort", t): explained(t * measured, own @ found) for t in EFFORTS_APART}
    signal, times = max(by_unit, key=lambda one: by_unit[one])
    most = by_unit[signal, times]
    other = share if signal == "effort" else max(share, _carried(measured, own, found))
    if most < FAMILIAR or 1.0 - most > HALF * (1.0 - other):
        return ""
    told = f"{most:.0%} of the variance is explained, as by another unit"
    return f"with its {signal} times {times:.4g} {told}"


def _of_another_sign(
    measured: np.ndarray, design: Callable[[float], np.ndarray], found: np.ndarray, share: float
) -> str:
    """Which of its signals, turned, makes a log fit the others' numbers; empty for none.

    Not where another force, payload or zero explains as much: these turn nothing that resists.
    """
    own = design(1.0)
    turned = {"effort": explained(-measured, own @ found)}
    turned["position"] = explained(measured, design(-1.0) @ found)
    most = max(turned.values())
    other = max(share, _carried(measured, own, found))
    if most < FAMILIAR or 1.0 - most > HALF * (1.0 - other):
        return ""
    either = [name for name, one in turned.items() if HALF * (1.0 - one) <= 1.0 - most]
    signals = " or ".join(f"its {name}'s" for name in either)
    return f"with {signals} sign turned {most:.0%} of the variance is explained"


def _carried(measured: np.ndarray, own: np.ndarray, found: np.ndarray) -> float:
    """Share that the others' inertia and friction explain beside its own force and weight."""
    resists, rest = own[:, :RESISTING] @ found[:RESISTING], own[:, RESISTING:]
    carried = rest @ np.linalg.lstsq(rest, measured - resists, rcond=None)[0]
    return explained(measured, resists + carried)


def _fitting(measured: np.ndarray, modelled: np.ndarray, about: float) -> float:
    """Share of one log's variance that a model explains.

    A log at one effort has none of its own: it counts about the `level` of all logs where the model
    fits it so.
    """
    share, beside = explained(measured, modelled), explained(measured, modelled, about)
    return beside if beside >= FAMILIAR else share


def level(problems: Sequence[InverseProblem]) -> float:
    """What efforts are counted about: their mean, or zero where all logs go one way.

    One way dry friction is a level, and viscous friction nearly so: it is a law that explains them.
    """
    if set(_ways(*problems)) in ({1}, {-1}):
        return 0.0
    return float(np.mean(np.concatenate([problem.measured() for problem in problems])))


def _mended(measured: np.ndarray, modelled: np.ndarray) -> str:
    """What takes most of what the others' model misses of a log; the share explained with it."""
    most = min(1.0 - FAMILIAR, HALF * (1.0 - explained(measured, modelled)))
    turned = explained(-measured, modelled)
    if turned > FAMILIAR:
        return f"with its effort's sign turned {turned:.0%} of the variance is explained"
    design = np.column_stack([modelled, np.ones_like(modelled)])
    (factor, offset), *_ = np.linalg.lstsq(design, measured, rcond=None)
    share = explained(measured, design @ (factor, offset))
    if 1.0 - share > most or factor <= 0.0:
        return ""
    if abs(factor - 1.0) < ALIKE:
        return f"with an offset of {offset:.3g} {share:.0%} of the variance is explained"
    return f"as {factor:.3g} times the model, {share:.0%} of the variance is explained"
