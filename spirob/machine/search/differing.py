"""Do the logs differ, by a number of their own, or by whole turns of their position?

A number of their own is another force, payload or zero in each: that of every log has to pass what
an effect has to pass, and the held-out logs must not deny it; of several that do, the one that fits
these best is taken, and of those that leave no more by what counts the one with the fewest numbers.
Where one does, a force that only the held-out logs have otherwise is one of them: it is plainer
than all others.

Whole turns: a position that begins again after a turn is unwrapped from where each log begins, so
logs of a motion over several turns may be some turns apart.  What depends on the place (a spring, a
tight spot) is then another curve in each.  The turn is taken by which one curve tells the most of
all logs: what the fitted numbers leave of the effort, as a piecewise linear function of the place,
beside and times the speed and its sign,

    argmin over k of  Σ (r - f_0(q + k·T) - v·f_1(q + k·T) - tanh(v/ω_0)·f_2(q + k·T))²

with f of the logs before, the one of the longest way first, then again with that of all others.
Rows where these never were count as they are.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import scipy

from spirob.diagnosis.model import Model
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.laws import LEVER
from spirob.machine.recordings.recording import Recording
from spirob.machine.search.models import RigSearch
from spirob.machine.search.plain_columns import RESISTING, plain_columns
from spirob.machine.search.preparation import Ready, search_of

KINDS = ("offset", "payload", "zero")  # of numbers that logs may have each for itself
PLAINEST = "offset"
FIRST = {"payload": 1.0, "zero": 0.0}  # of the first log, where the others count from it
KNOTS = 8  # in a turn: what changes faster comes round with it
MOST = 20  # turns that a log is looked for, either way
PASSES = 3  # over fits of the numbers
ROUNDS = 2  # the logs that come first have seen little of the way
TELLS = 0.5  # of the squared residual: less says nothing of the turn
WITHIN = 0.1  # of the squares of all logs together
PRIOR = 1e-3  # of the columns' mean square, against what few rows tell


def differing(
    ready: Ready, search: RigSearch, chosen: Model, rival: Model | None = None
) -> tuple[Ready, str] | None:
    """The rig whose logs differ by the plainest kind that fits as the best, and what is said of it.

    rival  of effects that the numbers of logs are to replace: they are to explain as much
    """
    told = {k: ready.told(per_log=(k,)) for k in KINDS if may_differ(k, ready.rig, search, chosen)}
    made = {kind: _fitted(one, chosen, kind) for kind, one in told.items()}
    alone = not {r.log for r in ready.test} <= {r.log for r in ready.train}
    fits = {
        kind: model
        for kind, model in made.items()
        if search.worth.matters(chosen, model)
        and not search.worth.denied(chosen, model)
        and tells(kind, model, alone)
        and not (rival and search.worth.matters(model, rival))
    }
    if not fits:
        return None
    if alone and PLAINEST not in fits:
        told[PLAINEST] = ready.told(per_log=(PLAINEST,))
        fits[PLAINEST] = _fitted(told[PLAINEST], chosen, PLAINEST)
    best = plainest(fits, search.worth.least)
    return told[best], _said(best, fits, search.models.size)


def plainest(fits: Mapping[str, Model], least: float) -> str:
    """The kind with the fewest numbers that leaves of the held-out logs what the best one leaves.

    least  size of what counts: what is left within its square of the best is the same
    """
    best = min(model.heldout_square for model in fits.values())
    alike = [kind for kind, model in fits.items() if model.heldout_square - best < least**2]
    return min(alike, key=lambda k: (len(fits[k].fit.estimates), fits[k].heldout_square))


def _fitted(told: Ready, chosen: Model, kind: str) -> Model:
    """The chosen effects with a number of each log; a zero shows by what depends on the place."""
    search, _ = search_of(told)
    weight = [e for e in search.candidates if e in LEVER.values() and e not in chosen.effects]
    effects = (*chosen.effects, *weight) if kind == "zero" else chosen.effects
    return search.models.fitted(effects, chosen.fit.changes)


def tells(kind: str, model: Model, alone: bool = False) -> bool:
    """Whether the numbers of two logs of a model lie apart, each within its interval.

    A payload that is counted in that of the first log has to do something, too.

    alone  whether a held-out log has a number for itself, which no interval is known of: the logs
           may differ by that
    """
    found = model.fit.estimates
    ends = [(e.low, e.high) for name, e in found.items() if name.startswith(f"{kind}.")]
    made = [e for name, e in found.items() if name.startswith("rig.payload_")]
    if kind == "payload" and made and all(e.low <= 0.0 <= e.high for e in made):
        return False
    if kind == "zero" or (kind == "payload" and made):
        ends.append((FIRST[kind], FIRST[kind]))
    return alone or max(low for low, _ in ends) > min(high for _, high in ends)


def _said(best: str, fits: Mapping[str, Model], size: float) -> str:
    """By which kind the logs differ, and the held-out error with each that explains more.

    size  RMS effort
    """
    left = {kind: f"{np.sqrt(m.heldout_square) / size:.2%}" for kind, m in fits.items()}
    others = "".join(f", with {kind} {left[kind]}" for kind in fits if kind != best)
    return (
        f"The logs differ by a number of their own, {best}: fitted for each. With it the held-out "
        f"logs leave {left[best]} of the effort{others}."
    )


def may_differ(kind: str, rig: RigFile, search: RigSearch, chosen: Model) -> bool:
    """Whether a kind of number may differ between the training logs, by what is left of a model.

    It may where its columns, one set for each log, take more of the squared residual than the least
    share of an effect beyond what the same columns take for all logs together.  A force may not
    where no log shows by itself how friction follows the speed: it would be that friction.
    """
    logs = {r.log for r in search.models.train.recordings}
    if rig.per_log is not None or rig.logs or len(logs) < 2:
        return False
    columns = _first_order(kind, rig, search)
    if columns is None or (kind == PLAINEST and not _shows_friction(search.models.train)):
        return False
    residual, edges = chosen.fit.residual, search.models.train.edges
    together = _left(columns, residual)
    apart = sum(_left(columns[a:b], residual[a:b]) for a, b in pairwise(edges))
    return together - apart > search.criteria.share * float(np.dot(residual, residual))


def _shows_friction(train: InverseProblem) -> bool:
    """Whether direction and speed differ within the logs, by a tenth of what they do in all."""
    for column in plain_columns(train)[1:RESISTING]:
        within = [np.var(column[a:b]) * (b - a) for a, b in pairwise(train.edges)]
        if sum(within) < WITHIN * np.var(column) * len(column):
            return False
    return True


def _first_order(kind: str, rig: RigFile, search: RigSearch) -> np.ndarray | None:
    """What a number of this kind does to the effort, to first order, (N, k); None where nothing."""
    signals = search.models.train.signals()
    ones = np.ones_like(signals["speed"])
    if kind == "offset":
        return ones[:, None]
    if not isinstance(rig.body, str) or rig.position is None:
        return None  # a body's payload hangs at its tip, which its model may not have
    if not rig.angular:
        return None if kind == "zero" else np.column_stack([signals["acceleration"], ones])
    turned = signals["position"]
    weight = [np.sin(turned), np.cos(turned)]
    return np.column_stack(weight if kind == "zero" else [signals["acceleration"], *weight])


def _left(columns: np.ndarray, residual: np.ndarray) -> float:
    found = np.linalg.lstsq(columns, residual, rcond=None)[0]
    return float(np.sum((residual - columns @ found) ** 2))


@dataclass(frozen=True)
class Log:
    """Rows of one log: place, speed over its RMS, its smooth sign, residual; (n,) each."""

    q: np.ndarray
    v: np.ndarray
    sign: np.ndarray
    residual: np.ndarray

    def moved(self, way: float) -> "Log":
        """The same from another turn."""
        return replace(self, q=self.q + way)


def counted_alike(ready: Ready) -> Ready:
    """Logs of one position count their turns alike, where what depends on the place tells how.

    Numbers that were fitted to uneven turns are fitted anew, and it is asked again.  Held-out logs
    are counted, too: a number of turns is no law that they could judge.
    """
    turn = max(r.turn for r in [*ready.train, *ready.test])
    if not turn or len({r.log for r in [*ready.train, *ready.test]}) < 2:
        return ready
    counted, moves = ready, Counter[str]()
    for _ in range(PASSES):
        more = _uneven(counted, turn)
        if not more:
            break
        moves.update(more)
        ways = {name: k * turn for name, k in more.items()}
        train, test = ([_shifted(r, ways) for r in rs] for rs in (counted.train, counted.test))
        counted = counted.with_logs(train, test)
    told = ", ".join(f"{name} {k:+d}" for name, k in sorted(moves.items()) if k)
    said = f"Turns that a wrapping position does not tell were counted by the effort: {told}."
    return replace(counted, said=[*ready.said, said]) if told else ready


def _uneven(ready: Ready, turn: float) -> dict[str, int]:
    """Logs that are whole turns further on than they say, by what the fitted numbers leave."""
    models = search_of(ready)[0].models
    bare = models.fitted((), {})
    logs = _logs(models.train, bare.fit.residual)
    logs |= {n: log for n, log in _logs(models.heldout, bare.heldout).items() if n not in logs}
    return {name: k for name, k in turns(list(logs.items()), turn).items() if k}


def turns(logs: Sequence[tuple[str, Log]], turn: float) -> dict[str, int]:
    """Whole turns by which each log, by name, is further on than it says."""
    (first, begin), *others = sorted(logs, key=lambda one: -float(np.ptp(one[1].q)))
    found, placed = {first: 0}, {first: begin}
    for _ in range(ROUNDS):
        for name, log in others:
            known = [one for other, one in placed.items() if other != name]
            found[name] = _best(known, log, turn)
            placed[name] = log.moved(found[name] * turn)
    return found


def _best(known: Sequence[Log], log: Log, turn: float) -> int:
    """The turn at which the curves of the known logs tell the most of another; 0 in doubt."""
    known, log = _of_turns(known, log, turn)
    low = min(float(one.q.min()) for one in known)
    high = max(float(one.q.max()) for one in known)
    curves = _curves(known, low, high, turn)
    ends = (low - float(log.q.max())) / turn, (high - float(log.q.min())) / turn
    tried = range(max(int(np.ceil(ends[0])), -MOST), min(int(np.floor(ends[1])), MOST) + 1)
    left = {0: float(np.sum(log.residual**2))}
    for k in tried:
        there = log.moved(k * turn)
        told = _columns(there, low, high, turn) @ curves
        left[k] = float(np.sum((log.residual - told) ** 2))
    best = min(left, key=lambda k: (left[k], abs(k)))
    enough = TELLS * min(left[0], float(np.sum(log.residual**2)))
    return best if left[best] < enough else 0


def _of_turns(known: Sequence[Log], log: Log, turn: float) -> tuple[list[Log], Log]:
    """The logs without what comes round in every turn, as dry friction does, by the known ones.

    It tells of no turn, and yet more where the curves reach than beyond them.
    """
    within = [replace(one, q=np.mod(one.q, turn)) for one in (*known, log)]
    curves = _curves(within[:-1], 0.0, turn, turn)
    less = [
        replace(one, residual=one.residual - _columns(inside, 0.0, turn, turn) @ curves)
        for one, inside in zip((*known, log), within, strict=True)
    ]
    return less[:-1], less[-1]


def _curves(known: Sequence[Log], low: float, high: float, turn: float) -> np.ndarray:
    """What the residuals of logs are by place, speed and its sign, (3·knots,)."""
    columns = scipy.sparse.vstack([_columns(one, low, high, turn) for one in known])
    products = columns.T @ columns
    power = PRIOR * products.diagonal() + 1e-300
    whole = scipy.sparse.csc_array(products + scipy.sparse.diags_array(power))
    wanted = columns.T @ np.concatenate([one.residual for one in known])
    return np.asarray(scipy.sparse.linalg.spsolve(whole, wanted))


def _columns(log: Log, low: float, high: float, turn: float) -> scipy.sparse.csr_array:
    """Piecewise linear functions of the place between two ends, zero beyond, (n, 3·knots)."""
    count = max(2, round(KNOTS * (high - low) / turn) + 1)
    at = (log.q - low) / (high - low) * (count - 1)
    before = np.clip(np.floor(at).astype(int), 0, count - 2)
    inside, share = (at >= 0.0) & (at <= count - 1), at - before
    cells = np.concatenate([before, before + 1])
    rows, hats = np.tile(np.arange(len(at)), 2), np.concatenate([1.0 - share, share])
    parts = [
        scipy.sparse.csr_array((np.tile(inside * by, 2) * hats, (rows, cells)), (len(at), count))
        for by in (np.ones_like(at), log.v, log.sign)
    ]
    return scipy.sparse.hstack(parts, format="csr")


def _logs(problem: InverseProblem, residual: np.ndarray) -> dict[str, Log]:
    """Rows of each log, by name; parts of one log are one."""
    signals = problem.signals()
    v = signals["speed"] / max(problem.sizes.speed, 1e-300)
    sign = np.tanh(signals["speed"] / problem.rest_speed)
    names = np.repeat([r.log for r in problem.recordings], np.diff(problem.edges))
    return {
        str(name): Log(signals["position"][rows], v[rows], sign[rows], residual[rows])
        for name in dict.fromkeys(names.tolist())
        for rows in [names == name]
    }


def _shifted(recording: Recording, ways: Mapping[str, float]) -> Recording:
    way = ways.get(recording.log, 0.0)
    pieces = [
        replace(p, q=p.q + way, reference=None if p.reference is None else p.reference + way)
        for p in recording.pieces
    ]
    return replace(recording, pieces=pieces) if way else recording
