"""The model that stands after a diagnosis, with all that another program needs to run it.

Named effects belong to it, others do not: what is undecided or unknown goes home as fitted numbers
alone.  The held-out logs go beside it, with what the model says of them, so that whoever runs it
elsewhere can be compared.
"""

import inspect
from typing import Any

import numpy as np
import pandas as pd

from spirob.effects import Effect, all_effects
from spirob.identify.intervals import covariance_of
from spirob.machine.body import RigidBody
from spirob.machine.inverse import InverseProblem
from spirob.machine.laws import AXIS, LEVER, LOAD_SIDE
from spirob.machine.models import ROBUST, Model
from spirob.machine.rig import NUMBERS
from spirob.machine.search import Search
from spirob.ports import PORTS

FORMAT = 1  # of the record; another one is refused by who reads it


def standing(search: Search, model: Model, body: RigidBody | None) -> dict[str, Any]:
    """The record of a model, in SI, as plain data.

    numbers   of the rig;  effects  with `source`, the module or file of their law, and numbers
    angle     position for one radian of the motor;  rest_speed  below which it stands
    fitted    names, values, 95 % intervals, bounds, units and covariance of what was fitted
    trials    of the held-out logs: name, sample period, cutoff of the filter, thinning
    """
    train, held, table = search.train, search.heldout, search.train.table
    p = table.vector(model.fit.changes)
    estimates = model.fit.estimates
    about = [table.about[name] for name in estimates]
    sizes = train.sizes
    return {
        "format": FORMAT,
        "machine": "axis",
        "axis": sizes.axis_unit,
        "effort_unit": sizes.effort_unit,
        "torque_unit": sizes.torque_unit,
        "numbers": {name: float(p[table.position(f"rig.{name}")]) for name in NUMBERS},
        "angle": sizes.angle,
        "rest_speed": train.rest_speed,
        "stiffness": train.body.stiffness if train.body else 0.0,
        "period": max(r.period for r in held.recordings),
        "effects": [
            {"name": e.name(), "source": source(e), "numbers": train.asked.values(e, p)}
            for e in _present(train, p)
        ],
        "fitted": {
            "names": list(estimates),
            "values": [e.value for e in estimates.values()],
            "intervals": [[e.low, e.high] for e in estimates.values()],
            "bounds": [[a.low, a.high] for a in about],
            "units": [e.unit for e in estimates.values()],
            "covariance": covariance_of(train, model.fit, ROBUST * search.models.size),
        },
        "body": None if body is None else _body(body),
        "trials": [
            {"name": r.name, "period": r.period, "cutoff": r.cutoff, "every": r.every}
            for r in held.recordings
        ],
    }


def heldout(search: Search, model: Model) -> pd.DataFrame:
    """The held-out logs, a row for each sample, and what the model says of them.

    trial, piece   numbers of the log and of its piece;  used  rows that are compared
    time, position, speed, acceleration  measured, as filtered;  effort  the same
    modelled, without  effort that the model asks for, unfiltered, with its effects and without
    carried, payload, offset, along, across  what the axis carries, N·m or N, and its own numbers
    """
    problem = search.heldout
    asked, table = problem.asked, problem.table
    p = table.vector(problem.completed(model.fit.changes))
    motion, bare = asked.motion, p.copy()
    for effect in _present(problem, p):
        cells = [table.position(f"{effect.name()}.{field}") for field in effect.neutral]
        bare[cells] = table.values[cells]
    n = len(motion.q)
    pieces = [(k, j) for k, r in enumerate(problem.recordings) for j, _ in enumerate(r.pieces)]
    counts = np.diff(motion.starts)
    used = np.zeros(n, bool)
    used[problem.compared] = True
    hung = asked.of_log("payload", p)
    tip = asked.tip_mass(p) + (hung if problem.body else 0.0)
    carried = motion.body["load"] + tip * motion.body["payload"] / problem.sizes.mass
    columns: dict[str, Any] = {
        "trial": np.repeat([k for k, _ in pieces], counts),
        "piece": np.repeat([j for _, j in pieces], counts),
        "used": used,
        "time": motion.seconds,
        "position": motion.q + asked.of_log("zero", p),
        "speed": motion.v,
        "acceleration": motion.a,
        "effort": motion.effort,
        "modelled": asked.effort(p),
        "without": asked.effort(bare),
        "carried": carried,
        "payload": np.zeros(n) + (0.0 if problem.body else hung),
        "offset": np.zeros(n) + asked.of_log("offset", p),
        "along": motion.body["along"],
        "across": motion.body["across"],
    }
    others = [piece.others for r in problem.recordings for piece in r.pieces]
    for name in others[0]:
        moved = np.concatenate([piece[name] for piece in others])
        for k, order in enumerate(("position", "speed", "acceleration")):
            columns[f"{order} of {name}"] = moved[:, k]
    return pd.DataFrame(columns)


def source(effect: type[Effect]) -> str:
    """Where an effect's law is stated: its module where the program knows it, else its file."""
    known = [*all_effects().values(), *AXIS.values(), *LOAD_SIDE.values(), *LEVER.values()]
    if effect in known:
        return effect.__module__
    return inspect.getfile(effect.kernel)


def _present(problem: InverseProblem, p: np.ndarray) -> list[type[Effect]]:
    """The effects that are not absent."""
    there = [e for port in PORTS for e in problem.asked.present(port, p)]
    return [e for e in problem.effects if e in there]


def _body(body: RigidBody) -> dict[str, Any]:
    told = body.body
    found: dict[str, Any] = {"file": str(body.file), "joint": told.joint, "tendon": told.tendon}
    return found | {"tip": told.tip, "others": list(told.joints)}
