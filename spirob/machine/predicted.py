"""What the models of a diagnosis predict of the motion: errors, and curves for the page."""

from typing import Any

import pandas as pd

from spirob.machine.forward import Forward, Prediction
from spirob.machine.forward.horizons import WINDOW
from spirob.machine.search import Found, Search


def predicted(search: Search, found: Found) -> tuple[dict[str, Any], pd.DataFrame | None]:
    """Errors of every rung and of guesses without a model, on both roles, and the motion drawn.

    Where a model cannot be run forward, {"absent": why} and no curves.  The curves are rows of both
    roles: trial, role, time, position, speed as measured, and MODEL_position_KIND and
    MODEL_speed_KIND, with MODEL base or named, KIND whole (from the start of each piece) or window
    (half seconds); all in SI.
    """
    runs = {"test": Forward(search.heldout), "train": Forward(search.train)}
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
    unit = search.train.sizes.axis_unit
    written = {
        "unit": unit,
        "speed_unit": f"{unit}/s",
        "effort_unit": search.train.effort.unit,
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
