"""Screen: which absent effects could explain the residual, alone, or several at once?

A race in three heats.  First the whole coupled model is differentiated by every effect's amplitudes
(all models are nested), so that each effect, in the motor, along the tendon or in the body, becomes
a few columns with all its consequences for motion and control in them; the residual is regressed on
them together with the columns of the fitted numbers, because a wrong parameter is not a missing
effect.  Then those that are promised most are simulated at the numbers that this promises them:
what a promise is worth, only the model can tell.  All correct their derivatives with what they saw
(Broyden), and those that then promise most are simulated again, twice.  An effect is ranked by the
best that it was seen to do.

Several candidates at once (`together`): each was fitted alone, and what that did to the residual is
known; so is the derivative of the residual by the fitted numbers.  Several together are taken as

    r = r_0 + Σ w_e·(r_e - r_0 - J·(u_e - u_0)) + J·(u - u_0),     0 ≤ w_e ≤ 1,

with the shares w and the coordinates u of the fitted numbers (see `scaling`) that cost least on the
training trials.  Only the numbers come from this sum; what they are worth, the model itself says
when it plays the trials again with them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spirob.diagnosis.orders import BY_LOAD, answers, best_orders, following
from spirob.effects import Effect
from spirob.effects.effect import differences
from spirob.errors import SimulationError
from spirob.identify.descent import Anchor, corrected, linear_step, robust_cost
from spirob.identify.fit import Fit, anchor_of
from spirob.identify.problem import Problem
from spirob.identify.scaling import Scaling

NUMBER = 0.1  # step of a fitted number
PROBE = 0.2  # of an amplitude's nominal value: small, yet far above rounding
TRIED = 0.5  # of the nominal value, where the derivatives promise nothing
SEEN = 0.1  # of the residual's RMS: what changes less of it is nothing
# candidates simulated in each; on eight robots the right one was promised 1st to 4th place
HEATS = (20, 8, 4)
ORDERS = ("order", "ratio", "third_ratio")  # of a ripple's waves, the further ones over the first
STEPS = 2  # of the linear problem, whose weights follow the residual
LINEAR_STEPS = 2  # of the linear problem, whose weights follow the residual


@dataclass(frozen=True)
class Screened:
    """One candidate after screening.

    gain     relative fall of the robust cost on the training trials, numbers refitted, as simulated
    changes  the numbers of that simulation, where the full fit may begin
    slopes   derivatives there, by the coordinates of `names`
    """

    effect: type[Effect]
    gain: float
    changes: dict[str, float]
    names: list[str]
    slopes: np.ndarray


@dataclass(frozen=True)
class _Runner:
    """A candidate on its way: coordinates, residual there, derivatives, cost with the anchor.

    absent  coordinates of its own amplitudes at which it vanishes
    probe   step of the first of them, with which it was differentiated
    """

    effect: type[Effect]
    scaling: Scaling
    anchor: Anchor
    fixed: Mapping[str, float]
    absent: np.ndarray
    probe: float
    u: np.ndarray
    residual: np.ndarray
    slopes: np.ndarray
    cost: float

    def changes(self) -> dict[str, float]:
        """All numbers at this point."""
        return self.at(self.u)

    def at(self, u: np.ndarray) -> dict[str, float]:
        """All numbers at another point."""
        return {**self.fixed, **self.scaling.physical(u)}


def screen(
    problem: Problem,
    base: Fit,
    fitted: Sequence[str],
    candidates: Sequence[type[Effect]],
    scale: float,
) -> list[Screened]:
    """Rank the candidates, best first; the model must hold them all, at their neutral numbers.

    base    the fit without them, of the numbers `fitted` (which may include other effects')
    scale   of the robust loss
    """
    runners = _started(problem, base, fitted, candidates, scale)
    for places in HEATS:
        # by what is promised, not by what was seen: from a poor start the first goal of the right
        # candidate may lie too far, and what was seen there corrects its derivatives
        runners.sort(key=lambda r: _promise(r, scale))
        runners = [*_heat(problem, runners[:places], scale), *runners[places:]]
    before = robust_cost(base.residual, scale)
    found = [
        Screened(
            r.effect,
            1.0 - robust_cost(r.residual, scale) / before,
            r.changes(),
            list(r.scaling.names),
            r.slopes,
        )
        for r in runners
    ]
    return sorted(found, key=lambda s: -s.gain)


def amplitudes(effect: type[Effect], problem: Problem) -> list[str]:
    """Full names of the numbers that make an effect vanish, its motors' differences included."""
    own = [*effect.neutral, *differences(effect)]
    return [n for n in (f"{effect.name()}.{f}" for f in own) if n in problem.table.about]


def without(
    effect: type[Effect], changes: Mapping[str, float], problem: Problem
) -> dict[str, float]:
    """These numbers with the effect taken out of the model, all others as they are."""
    own = amplitudes(effect, problem)
    return {name: value for name, value in changes.items() if name not in own}


def _started(
    problem: Problem,
    base: Fit,
    fitted: Sequence[str],
    candidates: Sequence[type[Effect]],
    scale: float,
) -> list[_Runner]:
    """All candidates at the base, with their derivatives, simulated together."""
    values = dict(zip(problem.table.names, problem.table.values.tolist(), strict=True))
    values |= base.changes
    shared = Scaling(problem.table, fitted)
    waves = _orders(problem, base, candidates)
    points, widths = beside(shared, shared.scaled(values), [NUMBER] * len(fitted), base.changes)
    plans = []
    for effect in candidates:
        names = amplitudes(effect, problem)
        scaling = Scaling(problem.table, [*fitted, *names])
        fixed = {**base.changes, **_shapes(effect), **waves.get(effect.name(), {})}
        u = scaling.scaled(values)
        steps = [_probe(problem, scaling, values, name) for name in names]
        moved, moves = beside(scaling, u, steps, fixed)
        plans.append((effect, scaling, fixed, u, moves))
        points += moved
    seen = iter(problem.many(points))
    first = [(next(seen) - base.residual) / w for w in widths]
    runners = []
    for effect, scaling, fixed, u, moves in plans:
        slopes = np.column_stack([*first, *((next(seen) - base.residual) / w for w in moves)])
        anchor = anchor_of(problem, scaling)
        cost = robust_cost(base.residual, scale) + anchor.cost(u)
        absent = u[-len(moves) :]
        runner = _Runner(
            effect, scaling, anchor, fixed, absent, moves[0], u, base.residual, slopes, cost
        )
        runners.append(runner)
    return runners


def _orders(
    problem: Problem, base: Fit, candidates: Sequence[type[Effect]]
) -> dict[str, dict[str, float]]:
    """Orders of the ripples among the candidates, from the residual."""
    found = {}
    ripples = [e for e in candidates if "order" in e.parameters() and e.port in BY_LOAD]
    if ripples and problem.rotors():
        trials = answers(problem, base, ripples[0])
        for effect in ripples:
            waves = [name for name in ORDERS if name in effect.parameters()]
            least = problem.table.about[f"{effect.name()}.order"].low
            orders = best_orders(base, following(trials, effect), len(waves), least)
            values = [orders[0] if k == 0 else n / orders[0] for k, n in enumerate(orders)]
            found[effect.name()] = {
                f"{effect.name()}.{name}": float(np.clip(value, about.low, about.high))
                for name, value in zip(waves, values, strict=False)
                for about in [effect.parameters()[name]]
            }
    return found


def beside(
    scaling: Scaling, u: np.ndarray, steps: Sequence[float], fixed: Mapping[str, float]
) -> tuple[list[dict[str, float]], list[float]]:
    """Points a step away along each of the last coordinates, and how far they are."""
    points, widths = [], []
    low, high = scaling.around(u)
    for k, step in enumerate(steps, len(u) - len(steps)):
        moved = u.copy()
        inside = low[k] <= u[k] + step <= high[k]
        moved[k] = np.clip(u[k] + (step if inside else -step), low[k], high[k])
        points.append({**fixed, **scaling.physical(moved)})
        widths.append(float(moved[k] - u[k]))
    return points, widths


def _probe(problem: Problem, scaling: Scaling, values: Mapping[str, float], name: str) -> float:
    """Step of an amplitude's coordinate: a second wave or a difference is probed as the first."""
    about, neutral = problem.table.about[name], values[name]
    size = about.nominal - neutral
    if size == 0.0:
        own = [n for n in scaling.names if n.split(".")[0] == name.split(".")[0]]
        alike = [problem.table.about[n] for n in own if problem.table.about[n].unit == about.unit]
        size = next((a.nominal for a in alike if a.nominal), 0.1 * (about.high - neutral))
    moved = scaling.scaled({**values, name: neutral + PROBE * size}) - scaling.scaled(values)
    return float(moved[scaling.names.index(name)])


def _shapes(effect: type[Effect]) -> dict[str, float]:
    """The numbers that give an effect its shape, at their nominal values."""
    about = effect.parameters()
    return {f"{effect.name()}.{f}": p.nominal for f, p in about.items() if f not in effect.neutral}


def _heat(problem: Problem, runners: Sequence[_Runner], scale: float) -> list[_Runner]:
    """Simulate every runner where its derivatives promise the least cost.

    One that no machine can be simulated with there stays where it is.
    """
    goals = [_goal(r, scale) for r in runners]
    points = [r.at(u) for r, u in zip(runners, goals, strict=True)]
    try:
        seen: Sequence[np.ndarray | None] = problem.many(points)
    except SimulationError:
        seen = [_simulated(problem, point) for point in points]
    return [
        runner if found is None else _moved(runner, goal, found, scale)
        for runner, goal, found in zip(runners, goals, seen, strict=True)
    ]


def _simulated(problem: Problem, point: Mapping[str, float]) -> np.ndarray | None:
    try:
        return problem(point)
    except SimulationError:
        return None


def _goal(runner: _Runner, scale: float) -> np.ndarray:
    scaling, u, own = runner.scaling, runner.u, len(runner.absent)
    box = scaling.around(u)
    goal = _solved(runner, box, scale)
    change = runner.slopes[:, -own:] @ (goal[-own:] - runner.absent)
    if np.linalg.norm(change) > SEEN * np.linalg.norm(runner.residual):
        return goal
    # no slope towards it: look at a size that would be seen
    k = len(u) - own
    step = runner.probe * TRIED / PROBE
    low, high = box[0].copy(), box[1].copy()
    low[k] = high[k] = np.clip(u[k] + step, low[k], high[k])
    return _solved(runner, (low, high), scale)


def _solved(runner: _Runner, box: tuple[np.ndarray, np.ndarray], scale: float) -> np.ndarray:
    u = runner.u
    for _ in range(STEPS):
        there = runner.residual + runner.slopes @ (u - runner.u)
        rows = runner.anchor.rows(u)
        step = linear_step(there, runner.slopes, (box[0] - u, box[1] - u), scale, rows)
        u = np.clip(u + step, *box)
    return u


def _promise(runner: _Runner, scale: float) -> float:
    """The cost that the derivatives promise."""
    goal = _goal(runner, scale)
    promised = runner.residual + runner.slopes @ (goal - runner.u)
    return robust_cost(promised, scale) + runner.anchor.cost(goal)


def _moved(runner: _Runner, goal: np.ndarray, seen: np.ndarray, scale: float) -> _Runner:
    slopes = corrected(runner.slopes, goal - runner.u, seen - runner.residual)
    cost = robust_cost(seen, scale) + runner.anchor.cost(goal)
    if cost < runner.cost:
        return replace(runner, u=goal, residual=seen, slopes=slopes, cost=cost)
    return replace(runner, slopes=slopes)


@dataclass(frozen=True)
class Alone:
    """A candidate added to the base model and fitted alone.

    changes   all numbers of that model;  residual  on the training trials
    refitted  fitted in full simulation; otherwise where the screening left it
    """

    effect: type[Effect]
    changes: dict[str, float]
    residual: np.ndarray
    refitted: bool = True


def together(
    problem: Problem, base: Fit, chosen: Sequence[Alone], scale: float
) -> dict[str, float]:
    """Numbers of the model with all the chosen effects; `problem` is that of the training trials.

    scale  of the robust loss, in the unit of the residual
    """
    table = problem.table
    scaling = Scaling(table, list(base.estimates))
    values = dict(zip(table.names, table.values.tolist(), strict=True)) | base.changes
    start = scaling.scaled(values)
    moves = [scaling.scaled({**values, **one.changes}) - start for one in chosen]
    shifts = [
        one.residual - base.residual - base.jacobian @ move
        for one, move in zip(chosen, moves, strict=True)
    ]
    slopes = np.column_stack([*shifts, base.jacobian])
    count = len(chosen)
    low = np.concatenate([np.zeros(count), scaling.low - start])
    high = np.concatenate([np.ones(count), scaling.high - start])
    anchor = anchor_of(problem, scaling)
    at = np.zeros(count + len(start))
    for _ in range(LINEAR_STEPS):
        rows, target = anchor.rows(start + at[count:])
        held = np.hstack([np.zeros((len(rows), count)), rows]), target
        there = base.residual + slopes @ at
        at = np.clip(at + linear_step(there, slopes, (low - at, high - at), scale, held), low, high)
    changes = dict(base.changes)
    for one, share in zip(chosen, at[:count], strict=True):
        changes |= _own(problem, one, float(share))
    return changes | scaling.physical(start + at[count:])


def _own(problem: Problem, one: Alone, share: float) -> dict[str, float]:
    """The candidate's own numbers with that share of its amplitudes; its shapes stay."""
    prefix, strengths = f"{one.effect.name()}.", set(amplitudes(one.effect, problem))
    found = {}
    for name, value in one.changes.items():
        if name.startswith(prefix):
            absent = float(problem.table.values[problem.table.position(name)])
            found[name] = absent + share * (value - absent) if name in strengths else value
    return found
