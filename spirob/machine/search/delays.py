"""Effort and motion on one clock: the delay between them, how large it may be, what exceeds it.

A controller holds its effort for a cycle, a drive answers one cycle later, channels are logged one
after the other: no log is aligned to better than a sample.  A filter, a bus or a logger may delay a
channel by tens of milliseconds besides.  Not fitted, that is friction, a lag, an elastic gear or an
efficiency to whatever effect is free to follow it.

So they are laid over one another where they fit best, whatever law the machine may have besides,

    argmin over δ of  min over effects of  min over p of |m(p) - e(t + δ)|²,   p in their bounds

where m is what the fitted numbers, dry friction, a weight and one effect of the library ask for on
the measured motion, linear in its amplitudes; e is the measured effort.  A delay turns inertia into
friction and friction into a spring, so it is told apart from what is missing only beside what may
be missing, and by bounds: an inertia or a friction below zero is none.  A law that holds a time or
a memory is late by itself, and no judge of it; one that turns round over a way is none where that
is short.  Shifting the effort changes no column, so all
delays cost little more than one.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spirob.diagnosis.model import Model
from spirob.diagnosis.regression import bounded
from spirob.effects import Effect
from spirob.errors import DataError
from spirob.machine.description.rig import Bounded, RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import ways
from spirob.machine.inverse.shapes import counts_periods, starts
from spirob.machine.laws import shares_inertia
from spirob.machine.recordings.recording import Recording
from spirob.machine.search.screening import Screening
from spirob.parameter import Parameter

# So far apart two channels of one log may be: a sample for the effort held over a cycle, one for
# the drive's answer, one for the order of logging; of a slow log the last alone
ROWS, FEW = 3.2, 1.5
LEAST, LONG = 1e-3, 0.02  # s: always possible, and beyond which it takes a slow log
DELAY = "rig.delay"
AS_LOGGED = Bounded(nominal=0.0, low=-LEAST, high=LEAST)  # to fit where a log means what it says
FARTHEST = 0.06  # s; public logs of real machines hold 16 to 50 ms
# of the delay by which a time acts there
SIGNS = {"sensing.current": 1.0, "sensing.report": 1.0, "sensing.frame": -1.0}


def usual(period: float) -> float:
    """Seconds by which effort and motion of any log may be apart, for its sample period."""
    return max(min(ROWS * period, LONG), FEW * period, LEAST)


def as_usual(period: float) -> Bounded:
    """A delay to fit that is no more than that of any log."""
    most = usual(period)
    return Bounded(nominal=0.0, low=-most, high=most)


def widened(delay: Bounded) -> Bounded:
    """The same with twice as wide bounds."""
    half = 0.5 * (delay.high - delay.low)
    return Bounded(nominal=delay.nominal, low=delay.low - half, high=delay.high + half)


def is_told(rig: RigFile) -> bool:
    """Whether the description says what to make of the delay."""
    return "delay" in rig.known or "delay" in rig.fit


def partnered(rig: RigFile, recordings: Sequence[Recording]) -> list[Recording]:
    """The trials without rows that the rig's delay, at most, leaves no partner.

    They are at the ends of pieces; where all of a trial is, nothing is left out.  Raises DataError
    where a known delay is longer than every piece of every trial.
    """
    fitted = rig.fit.get("delay")
    known = rig.known.get("delay", 0.0)
    farthest = abs(known) if fitted is None else max(fitted.high, -fitted.low)
    cut = [inside(r, farthest) for r in recordings]
    if cut and fitted is None and not any(r.pieces for r in cut):
        raise DataError(
            f"known.delay: {known:.3g} s leave no row a partner in what is fitted, or held out, of "
            "the logs: is it in seconds?"
        )
    return cut if all(r.pieces for r in cut) else list(recordings)


def strange(rig: RigFile, recordings: Sequence[Recording]) -> list[str]:
    """What is said of a delay in the description by which the motion turns into another.

    After a quarter of its period inertia looks like friction, and friction like a spring.
    """
    fitted, known = rig.fit.get("delay"), rig.known.get("delay", 0.0)
    told = known if fitted is None else max(fitted.low, fitted.high, key=abs)
    quarter = turning(recordings)
    if abs(told) < quarter:
        return []
    return [
        f"A delay of {told:.3g} s is allowed, and the motion turns in {quarter:.2g} s, by which "
        "inertia and friction are no longer told apart: is it in seconds?"
    ]


def turning(recordings: Sequence[Recording]) -> float:
    """Seconds by which a motion turns into another: a quarter of its period."""
    speeds, rates = (
        np.concatenate([getattr(p, name)[p.use] for r in recordings for p in r.pieces])
        for name in "va"
    )
    return 0.5 * np.pi * float(np.std(speeds) / max(float(np.std(rates)), 1e-300))


def inside(recording: Recording, delay: float) -> Recording:
    """The trial without the rows that a delay of this size, either way, leaves no partner."""
    ends = round(delay / recording.period)
    cut = [replace(p, use=p.use & _within(len(p.q), ends)) for p in recording.pieces]
    return replace(recording, pieces=recording.worth(cut))


def only_aligns(model: Model, rig: RigFile, period: float) -> bool:
    """Whether a lag or latency of a model is no more than logs are apart anyway.

    Against a delay of the other sign it does nothing but smooth, and whatever smooths a model of
    noisy motion fits better.
    """
    told = rig.fit.get("delay")
    return told is not None and bool(_aligning(model, rig, period, told.nominal))


def only_smoothing(model: Model, rig: RigFile, period: float) -> set[str]:
    """Names of lags and latencies that make, with the delay wherever it was placed, no more than
    logs are apart anyway."""
    return _aligning(model, rig, period, 0.0) if "delay" in rig.fit else set()


def _aligning(model: Model, rig: RigFile, period: float, about: float) -> set[str]:
    told, found = rig.fit["delay"], set()
    most = min(told.high - told.nominal, usual(period))
    delay = model.fit.changes[DELAY] - about
    for effect in model.effects:
        times = [f for f in effect.neutral if effect.parameters()[f].unit == "s"]
        for field in times if effect.port in SIGNS else ():
            age = model.fit.changes[f"{effect.name()}.{field}"]
            if age + SIGNS[effect.port] * delay <= most:
                found.add(effect.name())
    return found


def _within(n: int, ends: int) -> np.ndarray:
    at = np.arange(n)
    return (at >= ends) & (at < n - ends)


FINE = 3  # steps of the search in the delay that is usual
ENOUGH = 4000  # rows to look for it
FEWEST = 50  # rows below which nothing is looked for
LOOKS = 9  # delays at which the orders of waves are looked for
GRAIN = 9  # digits of a delay [s]: what differs by less differs by rounding
TOLD = 0.1  # of the squared error: what leaves more is no place


@dataclass(frozen=True)
class _Law:
    """Products of a law's columns with one another (n, n) and with the residuals (n, K)."""

    gram: np.ndarray
    side: np.ndarray
    low: np.ndarray
    high: np.ndarray

    def falls(self) -> np.ndarray:
        """Fall of the squared residual at each delay, within bounds, (K,)."""
        side = self.side.T
        moved = bounded(self.gram[None], side, self.low, self.high)
        return np.asarray(-np.sum(moved * (2.0 * side + moved @ self.gram), axis=1))


def place(
    problem: InverseProblem, model: Model, folds: np.ndarray, effects: Sequence[type[Effect]]
) -> Bounded:
    """Seconds by which the effort trails the motion, bounds as far about as the logs leave open.

    Where a usual one leaves hardly more than the best one, it is taken, within what is usual and a
    step of the look beyond the place: beside a law that is not found yet many delays are alike.
    Else bounds hold all that leave hardly more; the best one at the end of what is looked at is
    none.

    model    fitted, at whatever delay;  effects  of which one may be missing of it
    """
    period = max(r.period for r in problem.recordings)
    most, here = usual(period), model.fit.changes.get(DELAY, 0.0)
    apart = max(period, most / FINE)
    far = round(FARTHEST / apart) + 1  # what lies at an end is a best place only if beyond is worse
    delays = apart * np.arange(-far, far + 1)
    rows, efforts = problem.later(delays - here, max(1, len(model.left) // ENOUGH))
    if len(rows) < FEWEST:
        return as_usual(period)
    residuals = (model.fit.residual + problem.measured())[rows, None] - efforts
    laws = _laws(problem, model, folds, rows, residuals, effects)
    left = np.sum(residuals**2, axis=0) - np.max([law.falls() for law in laws], axis=0)
    best, first, last = valley(left, np.abs(delays) <= most)
    told = delays[best], delays[first], delays[last], most, apart
    nominal, low, high, near, step = (round(float(x), GRAIN) for x in told)
    if best in (0, len(delays) - 1):
        return as_usual(period)
    if low <= near and high >= -near:
        nominal = min(max(nominal, -near), near)
        return Bounded(
            nominal=nominal, low=min(-near, nominal - step), high=max(near, nominal + step)
        )
    return Bounded(nominal=nominal, low=low - near, high=high + near)


def valley(left: np.ndarray, usual: np.ndarray) -> tuple[int, int, int]:
    """A place, and the first and last around it that leave hardly more than any, of (K,).

    It is the best one, of the usual ones (K,) where one of those leaves hardly more.
    """
    enough = left <= np.min(left) / (1.0 - TOLD)
    allowed = enough & usual if np.any(enough & usual) else enough
    k = int(np.argmin(np.where(allowed, left, np.inf)))
    out = np.flatnonzero(~enough)
    first = int(np.max(out[out < k], initial=-1)) + 1
    last = int(np.min(out[out > k], initial=len(left))) - 1
    return k, first, last


def _laws(
    problem: InverseProblem,
    model: Model,
    folds: np.ndarray,
    rows: np.ndarray,
    residuals: np.ndarray,
    effects: Sequence[type[Effect]],
) -> list[_Law]:
    """The fitted numbers with what most axes have, and each effect besides in several shapes."""
    screening = Screening(problem, model.fit, folds)
    own = [k for k, name in enumerate(screening.names) if name != DELAY]
    common = _common(problem, model)
    base = np.hstack([screening.jacobian[:, own], common])[rows]
    free = np.full(common.shape[1], np.inf)
    low = np.hstack([screening.room[0][own], 0.0, -free[1:]])
    high = np.hstack([screening.room[1][own], free])
    made = [_Law(base.T @ base, base.T @ residuals, low, high)]
    signals = {name: values[rows] for name, values in screening.signals.items()}
    momentary = [e for e in effects if _is_momentary(e)]
    looks = residuals[:, :: max(1, residuals.shape[1] // LOOKS)].T
    for effect in momentary:
        about = {f: problem.table.about[f"{effect.name()}.{f}"] for f in effect.parameters()}
        waves = any(counts_periods(effect, f) for f in about if f not in effect.neutral)
        known: dict[tuple[object, ...], np.ndarray] = {}
        for residual in looks if waves else looks[:1]:
            for shape in _at_once(effect, about, starts(effect, about, residual, signals)):
                probed = screening.probe(effect, shape, known)
                columns = np.hstack([base, probed.columns[rows]])
                edges = np.hstack([low, probed.low]), np.hstack([high, probed.high])
                made.append(_Law(columns.T @ columns, columns.T @ residuals, *edges))
    return made


def _is_momentary(effect: type[Effect]) -> bool:
    """Whether a law holds no time, and no memory but of a way."""
    remembers = effect.state and (not ways(effect) or shares_inertia(effect))
    return not remembers and effect.port not in SIGNS


def _at_once(
    effect: type[Effect], about: Mapping[str, Parameter], shapes: Sequence[dict[str, float]]
) -> list[dict[str, float]]:
    """These shapes, each once, with the shortest way to turn round."""
    short = {name: about[name].low for name in ways(effect)}
    return list({tuple(at.values()): at for at in (shape | short for shape in shapes)}.values())


def _common(problem: InverseProblem, model: Model) -> np.ndarray:
    """What dry friction, a force and a weight change of the residual, (N, 2 or 4)."""
    motion = problem.asked.motion
    torques = [-np.tanh(motion.v / problem.rest_speed), np.ones_like(motion.v)]
    if problem.rig.position is not None and problem.sizes.axis_unit == "rad":
        torques += [np.sin(motion.q), np.cos(motion.q)]
    return np.column_stack([problem.shown(torque, model.fit.changes) for torque in torques])
