"""A rig's diagnosis as plain data (`diagnosis.json`), and the model that stands after it.

The model is told with all that another program needs to run it.  Named effects belong to it, others
do not: what is undecided or unknown goes home as fitted numbers alone.  The held-out logs go beside
it, with what the model says of them, so that whoever runs it elsewhere can be compared.
"""

import inspect
import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
import pandas as pd

from spirob.diagnosis.atlas import atlas, lateness, worst
from spirob.diagnosis.criteria import half_seconds, noise_floor
from spirob.diagnosis.document import CEILING, candidates, findings, numbers
from spirob.diagnosis.flexible import worth
from spirob.diagnosis.model import Found, Model
from spirob.diagnosis.schema import checked
from spirob.diagnosis.spectrum import orders
from spirob.effects import Effect
from spirob.identify.intervals import Interval, covariance_of, score, score_interval
from spirob.identify.problem import rms
from spirob.machine.composed.law import beyond
from spirob.machine.description.rig import NUMBERS
from spirob.machine.inverse.body import RigidBody
from spirob.machine.inverse.numbers import USUAL
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.laws import by_module
from spirob.machine.page_tables import laws, overlay, parameters, predicted, switches
from spirob.machine.result import Diagnosis
from spirob.machine.search.judging import Judged
from spirob.machine.search.leftovers import RigCeiling
from spirob.machine.search.models import RigSearch
from spirob.machine.search.odd_logs import way_of
from spirob.machine.search.plausibility import oddities
from spirob.ports import PORTS

SHORTER = "fewer or slower rows make it shorter."
CUT = f"The search took so long that no more than three effects were tried together: {SHORTER}"


def written(judged: Judged) -> Diagnosis:
    """What was found of a rig, as plain data and for its page."""
    search, found, law = judged.search, judged.found, judged.law
    ready, gate, named = judged.done.ready, judged.done.gate, judged.verdict.kind == "named"
    train, held = search.models.train, search.models.heldout
    bare, chosen = found.rungs[0], found.chosen
    notes = [*ready.said, *[CUT] * search.models.cut]
    notes += oddities(search, chosen, gate, ready.given, not judged.verdict.doubts)
    notes += beyond((train, held), ready.own, chosen.fit.changes)
    document = _document(judged, notes)
    ranked = [c["name"] for c in document["candidates"]]
    document["switches"] = switches(search, found, ranked)
    document["composed"] = law.document if law else None
    stands = chosen if named else bare
    document["model"] = standing(search, stands, ready.body)
    curves = None
    if ready.rig.predict != "effort":
        document["motion"], curves = predicted(search, found)
    return Diagnosis(
        checked(plain(document)),
        overlay(search, bare.fit, chosen.fit),
        parameters(search, bare.fit),
        gate.sentence,
        laws(held, chosen.effects, chosen.fit.changes, held.sizes.axis_unit),
        curves,
        law,
        heldout(search, stands),
    )


def _document(judged: Judged, notes: Sequence[str]) -> dict[str, Any]:
    """All of a diagnosis, in SI; a number that is not finite becomes null."""
    search, found, verdict, rest = judged.search, judged.found, judged.verdict, judged.rest
    effort, ready = search.models.train.effort, judged.done.ready
    pieces, bare = search.models.train.stretches(), found.rungs[0].fit.residual
    regimes = atlas(search.models.train, bare)
    return {
        "rig": ready.rig.name,
        "predict": ready.rig.predict,
        "verdict": verdict.kind,
        "sentence": verdict.sentence,
        "explanation": verdict.explanation,
        "doubts": list(verdict.doubts),
        "next_experiment": verdict.next_experiment,
        **findings(verdict, found.chosen),
        "candidates": candidates(search, found, verdict),
        "ladder": [*_ladder(search, found), _flexible(search, found, rest)],
        "noise_floor": noise_floor(search.models.train),
        "atlas": [asdict(r) for r in regimes],
        "atlas_sentences": worst(regimes, effort),
        "atlas_orders": [asdict(w) for w in orders(pieces, bare)],
        "atlas_lateness": lateness(pieces, bare),
        "unit": effort.unit,
        "effort": effort.name,
        "effort_rms": {"train": search.models.size, "test": rms(search.models.heldout.measured())},
        "repairs": list(notes),
        "excluded": ready.excluded,
        "numbers": numbers(found.chosen, "rig"),
        "left": {"share": rest.share, "alone": rest.alone},
    }


def _ladder(search: RigSearch, found: Found) -> list[dict[str, Any]]:
    rungs = []
    for model in found.rungs:
        names = [e.name() for e in model.effects]
        label = " + ".join(["fitted numbers", *(n.replace("_", " ") for n in names)])
        both = {role: s.as_dict() for role, s in search.models.scores(model).items()}
        intervals = _intervals(search, model.fit.residual, model.heldout)
        rungs.append({"label": label, "effects": names, **both, "interval": intervals})
    return rungs


def _flexible(search: RigSearch, found: Found, rest: RigCeiling) -> dict[str, Any]:
    """The ceiling: what a flexible residual on top of the chosen model would reach."""
    measured, held = search.models.train.measured(), search.models.heldout.measured()
    before = found.chosen.fit.residual
    guess = before - rest.left
    left = before - worth(before, guess) * guess  # as on the held-out trials
    return {
        "label": CEILING,
        "effects": [],
        "train": score(measured, measured + left).as_dict(),
        "test": score(held, held + rest.heldout).as_dict(),
        "interval": _intervals(search, left, rest.heldout),
        "ceiling": True,
    }


def _intervals(
    search: RigSearch, train: np.ndarray, heldout: np.ndarray
) -> dict[str, dict[str, Interval]]:
    """95 % intervals of the scores of what a model misses on either role, (N,) and (M,)."""
    found = {}
    for role, problem, missed in (
        ("train", search.models.train, train),
        ("test", search.models.heldout, heldout),
    ):
        measured = problem.measured()
        found[role] = score_interval(measured, measured + missed, half_seconds(problem))
    return found


def plain(node: Any) -> Any:
    """Plain data of nine digits; a number that is not finite becomes null."""
    if isinstance(node, dict):
        return {str(key): plain(value) for key, value in node.items()}
    if isinstance(node, list | tuple):
        return [plain(value) for value in node]
    if isinstance(node, float | np.floating):
        return float(f"{node:.9g}") if math.isfinite(node) else None
    return node.item() if isinstance(node, np.generic) else node


FORMAT = 1  # of the record; another one is refused by who reads it


def standing(search: RigSearch, model: Model, body: RigidBody | None) -> dict[str, Any]:
    """The record of a model, in SI, as plain data.

    numbers   of the rig;  effects  with `source`, the module or file of their law, and numbers
    angle     position for one radian of the motor;  rest_speed  below which it stands
    fitted    names, values, 95 % intervals, bounds, units and covariance of what was fitted
    trials    of the held-out logs: name, sample period, cutoff of the filter, thinning
    way       1 or -1 where the logs that were fitted move this way only, 0 for both
    """
    train, held, table = search.models.train, search.models.heldout, search.models.train.table
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
        "usual": {kind: float(np.mean(train.asked.of_log(kind, p))) for kind in USUAL},
        "angle": sizes.angle,
        "rest_speed": train.rest_speed,
        "stiffness": train.body.stiffness if train.body else 0.0,
        "way": way_of(train.signals()["speed"], train.rest_speed),
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
            "covariance": covariance_of(train, model.fit, search.models.robust),
        },
        "body": None if body is None else _body(body),
        "trials": [
            {"name": r.name, "period": r.period, "cutoff": r.cutoff, "every": r.every}
            for r in held.recordings
        ],
    }


def heldout(search: RigSearch, model: Model) -> pd.DataFrame:
    """The held-out logs, a row for each sample, and what the model says of them.

    trial, piece   numbers of the log and of its piece;  used  rows that are compared
    time, position, speed, acceleration  measured, as filtered;  effort  the same
    modelled, without  effort that the model asks for, unfiltered, with its effects and without
    carried, payload, offset, along, across  what the axis carries, N·m or N, and its own numbers
    """
    problem = search.models.heldout
    asked, table = problem.asked.anew(), problem.table
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
        "position": motion.q - asked.of_log("zero", p),
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
    if effect.__module__ in by_module():
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
