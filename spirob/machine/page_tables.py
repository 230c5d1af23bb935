"""What the page shows of a rig's models: effort, motion run forward, fitted numbers, switches.

The switches tell what any combination of a rig's first candidates leaves.
"""

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd

from spirob.diagnosis.atlas import masks_of
from spirob.diagnosis.model import Found, Model
from spirob.diagnosis.screen import without
from spirob.effects import Effect
from spirob.identify.fit import Fit
from spirob.identify.intervals import with_bounds
from spirob.identify.problem import Problem, rms
from spirob.machine.forward import WINDOW, Forward, Prediction
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.search.models import RigSearch

MOST = 3  # effects: seven combinations, of which the search has fitted most


def switches(search: RigSearch, found: Found, ranked: Sequence[str]) -> list[dict[str, Any]]:
    """Every combination of the chosen effects and the next of `ranked`, fewer effects first.

    Each is fitted in full beside what the model holds.

    effects  names;  how  "base", "verdict" (the chosen set) or "refitted"
    rmse     RMS error by role;  regimes  the same by regime, over both roles; unit of the effort
    """
    bare, chosen, known = found.rungs[0], found.chosen, search.models.tried
    singles = [m for m in known.values() if len(m.names - bare.names) == 1 and bare.names < m.names]
    alone = {next(iter(m.names - bare.names)): m for m in singles}
    rest = [n for n in ranked if n in alone and n not in chosen.names]
    names = [*(n for n in ranked if n in alone and n in chosen.names), *rest][:MOST]
    made = [_entry(search, (), "base", bare.fit.changes)]
    for count in range(1, len(names) + 1):
        for subset in combinations(names, count):
            if bare.names | set(subset) == chosen.names:
                made.append(_entry(search, subset, "verdict", chosen.fit.changes))
                continue
            best = min((alone[n] for n in subset), key=lambda m: m.mean_square)
            effects = [*bare.effects, *(_of(alone[n], n) for n in subset)]
            start = {k: v for n in subset for k, v in alone[n].fit.changes.items()}
            fit = search.models.numbers(tuple(effects), start | best.fit.changes)
            made.append(_entry(search, subset, "refitted", fit.changes))
    return made


def _of(model: Model, name: str) -> type[Effect]:
    return next(e for e in model.effects if e.name() == name)


def _entry(
    search: RigSearch, effects: Sequence[str], how: str, changes: Mapping[str, float]
) -> dict[str, Any]:
    left = {"train": search.models.train(changes), "test": search.models.heldout(changes)}
    return {
        "effects": list(effects),
        "how": how,
        "rmse": {role: rms(values) for role, values in left.items()},
        "regimes": _by_regime(search, left),
    }


def _by_regime(search: RigSearch, left: Mapping[str, np.ndarray]) -> dict[str, float]:
    inside: dict[str, list[np.ndarray]] = {}
    for role, problem in (("train", search.models.train), ("test", search.models.heldout)):
        for piece, values in _pieces(problem, left[role]):
            for name, mask in masks_of(piece).items():
                inside.setdefault(name, []).append(values[mask])
    joined = {name: np.concatenate(parts) for name, parts in inside.items()}
    return {name: rms(values) for name, values in joined.items() if len(values)}


def _pieces(problem: InverseProblem, left: np.ndarray) -> list[tuple[Any, np.ndarray]]:
    pieces = problem.stretches()
    edges = np.cumsum([0, *(len(p.seconds) for p in pieces)])
    return [(p, left[a:b]) for p, a, b in zip(pieces, edges, edges[1:], strict=False)]


def overlay(search: RigSearch, base: Fit, named: Fit) -> pd.DataFrame:
    """Rows of both roles: trial, role, time, position, measured, base, named."""
    parts = []
    for role, problem in (("test", search.models.heldout), ("train", search.models.train)):
        lines = {"base": problem(base.changes), "named": problem(named.changes)}
        measured, at = problem.measured(), 0
        for stretch in problem.stretches():
            rows = slice(at, at + len(stretch.seconds))
            at = rows.stop
            columns: dict[str, Any] = {"trial": stretch.trial, "role": role}
            columns |= {"time": stretch.seconds, "position": stretch.position}
            columns |= {"measured": measured[rows]}
            columns |= {name: measured[rows] + line[rows] for name, line in lines.items()}
            parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True)


def laws(
    problem: Problem, effects: Sequence[type[Effect]], changes: Mapping[str, float], axis: str
) -> pd.DataFrame:
    """Rows of samples of the effort for each effect of a model: effect, signals, shown and law.

    problem  held-out trials, of a plain rig or of the arm;  changes  the model's numbers
    axis     unit of the position in it, which the rows name

    All other numbers as fitted,  shown = measured - without,  law = with - without,  in the unit
    of the effort; position and velocity in that of the axis.
    """
    rows, pieces = problem.rows, problem.stretches()
    along = {"time": "seconds", "position": "position", "velocity": "velocity"}
    signals: dict[str, Any] = {
        name: np.concatenate([getattr(p, field) for p in pieces]) for name, field in along.items()
    }
    signals |= {"axis": axis, "effort": problem.measured()[rows]}
    held, parts = problem(changes)[rows], []
    for effect in effects:
        bare = problem(without(effect, changes, problem))[rows]
        columns = {"effect": effect.name(), **signals, "shown": -bare, "law": held - bare}
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame({"effect": []})


def parameters(search: RigSearch, fit: Fit) -> dict[str, Any]:
    """Fitted numbers of a model, with their bounds."""
    found = with_bounds(fit.estimates, search.models.train.table)
    return {name.removeprefix("rig."): about for name, about in found.items()}


def predicted(search: RigSearch, found: Found) -> tuple[dict[str, Any], pd.DataFrame | None]:
    """Errors of every rung and of guesses without a model, on both roles, and the motion drawn.

    Where a model cannot be run forward, {"absent": why} and no curves.  The curves are rows of both
    roles: trial, role, time, position, speed as measured, and MODEL_position_KIND and
    MODEL_speed_KIND, with MODEL base or named, KIND whole (from the start of each piece) or window
    (half seconds); all in SI.
    """
    runs = {"test": Forward(search.models.heldout), "train": Forward(search.models.train)}
    for model in found.rungs:
        for run in runs.values():
            if reason := run.absent(model.fit.changes):
                return {"absent": reason}, None
    rungs: list[dict[str, Any]] = []
    drawn: dict[str, dict[str, Prediction]] = {role: {} for role in runs}
    for model in found.rungs:
        rung: dict[str, Any] = {"effects": [e.name() for e in model.effects]}
        for role, run in runs.items():
            made = run.predicted(model.fit.changes)
            rung[role] = run.errors(model.fit.changes, made)
            if model is found.rungs[0]:
                drawn[role]["base"] = made
            if model is found.chosen:
                drawn[role]["named"] = made
        rungs.append(rung)
    guessed = {role: run.guessed() for role, run in runs.items()}
    unit = search.models.train.sizes.axis_unit
    written = {
        "unit": unit,
        "speed_unit": f"{unit}/s",
        "effort_unit": search.models.train.effort.unit,
        "horizon": WINDOW,
        "rungs": rungs,
        "guesses": [
            {"name": name, **{role: guessed[role][name] for role in runs}}
            for name in guessed["test"]
        ],
    }
    curves = [_curves(run, role, drawn[role]) for role, run in runs.items()]
    return written, pd.concat(curves, ignore_index=True)


def _curves(run: Forward, role: str, drawn: dict[str, Prediction]) -> pd.DataFrame:
    problem = run.problem
    motion = problem.asked.motion
    names = [r.name for r in problem.recordings for p in r.pieces for _ in p.q]
    columns: dict[str, Any] = {"trial": names, "role": role, "time": motion.seconds}
    columns |= {"position": motion.q, "speed": motion.v}
    for model, made in drawn.items():
        for kind, values in (("whole", made.long), ("window", made.short)):
            if values is not None:
                columns[f"{model}_position_{kind}"] = values[0]
                columns[f"{model}_speed_{kind}"] = values[1]
    table = pd.DataFrame(columns)
    return table[table["base_position_whole"].notna()]
