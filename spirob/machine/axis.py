"""The diagnosis of a plain rig from its recordings: check, fit, search, judge."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from spirob.diagnose.atlas import atlas
from spirob.effects import Effect, all_effects
from spirob.errors import ConfigError
from spirob.identify.identifiability import Identifiability, probe
from spirob.machine.alignment import with_delay
from spirob.machine.body import RigidBody
from spirob.machine.candidates import applicable, with_room
from spirob.machine.document import document, plain
from spirob.machine.flexible import Ceiling, ceiling
from spirob.machine.inverse import InverseProblem
from spirob.machine.judgement import judge
from spirob.machine.laws import for_axis
from spirob.machine.models import Model
from spirob.machine.own_effects import chosen, files
from spirob.machine.plausible import doubts, oddities
from spirob.machine.predicted import predicted
from spirob.machine.recording import Recording
from spirob.machine.rig import ANGLES, RigFile
from spirob.machine.search import Found, Search
from spirob.machine.shown import laws, overlay, parameters
from spirob.machine.sizes_of import sizes_of
from spirob.machine.splitting import split
from spirob.machine.standstill import without_holds
from spirob.machine.worth import Settings


@dataclass(frozen=True)
class Diagnosis:
    """Everything that a diagnosis found; `document` is what is written.

    overlay     per sample: trial, role, time, position, measured, base, named
    parameters  of the bare model, for the page
    laws        per held-out sample what each effect of the chosen model does
    motion      measured and predicted, see `predicted`; None where it was not asked for
    """

    document: dict[str, Any]
    overlay: pd.DataFrame
    parameters: dict[str, Any]
    identifiability: str
    laws: pd.DataFrame
    motion: pd.DataFrame | None = None


def diagnose_recordings(
    rig: RigFile,
    folder: Path,
    train: list[Recording],
    test: list[Recording],
    settings: Settings | None = None,
    progress: Callable[[str], None] = lambda text: None,
    own: Sequence[type[Effect]] | None = None,
) -> Diagnosis:
    """Diagnose a machine from trials that are read already.

    own  the effects that the model holds, where they are found already
    """
    if not train:
        raise ConfigError("a diagnosis needs at least one training log")
    settings = settings or Settings()
    repairs = [text for r in [*train, *test] for text in r.said]
    train, test, said = split(train, test)
    repairs += said
    angular = rig.position.unit in ANGLES
    body = None if isinstance(rig.body, str) else RigidBody(rig.body, folder, angular)
    turned = 0.0 if body or not angular else _stroke(train)
    own = chosen(files(rig.effects, folder)) if own is None else own
    own = for_axis(own, turned)
    library = [*own, *(e for e in for_axis(all_effects().values(), turned) if e not in own)]
    has_tip = not isinstance(rig.body, str) and rig.body.tip is not None
    stiffness = body.stiffness if body else 0.0
    possible, excluded = applicable(library, rig, has_tip, stiffness, angular)
    sizes, rest = sizes_of(rig, body, train)
    possible, small = with_room(possible, sizes)
    excluded |= small
    if missing := [e.name() for e in own if e not in possible]:
        raise ConfigError(f"effects: {missing[0]} cannot act here: {excluded[missing[0]]}")
    rig = with_delay(rig, max(r.period for r in train))
    if rig.rows.standstill == "drop" and rig.rows.minimum_speed is None:
        (train, lost), (test, more) = (without_holds(r, rest) for r in (train, test))
        repairs += [*lost, *more]
    problems = [InverseProblem(rig, body, r, possible, sizes, rest) for r in (train, test)]
    names = [f"rig.{name}" for name in rig.fit]
    names += [f"{e.name()}.{f}" for e in own for f in e.parameters()]
    if names == ["rig.delay"]:
        raise ConfigError("fit: name at least one number to fit, such as viscous")
    table = problems[0].table
    asked = [n for n in names if n != "rig.delay"]  # by a sample or two: it cannot be silent
    gate = probe(problems[0], asked, {n: table.about[n].nominal for n in asked})
    if gate.silent:
        raise ConfigError(f"fit: {gate.sentence}")
    candidates = [e for e in possible if e not in own]
    search = Search(problems[0], problems[1], names, candidates, settings, progress)
    # small matrices and trees lose more time to waiting threads than they win
    with threadpool_limits(1):
        return _finish(rig, search, search.run(), gate, repairs, excluded)


def _finish(
    rig: RigFile,
    search: Search,
    found: Found,
    gate: Identifiability,
    repairs: list[str],
    excluded: dict[str, str],
) -> Diagnosis:
    problems = search.train, search.heldout
    rest = _ceiling(search, found.chosen)
    while (lesser := search.without_imitations(found, rest.share)) is not None:
        found, rest = lesser, _ceiling(search, lesser.chosen)
    bare, chosen = found.rungs[0], found.chosen
    low = rest
    if chosen is not bare:
        low = ceiling(*problems, bare.fit.residual, bare.heldout, search.models.folds, split=False)
    warnings = doubts(search, found, rest, gate)
    judgement = judge(search, found, low, rest, warnings)
    notes = [*repairs, *oddities(search, chosen)]
    regimes = atlas(search.train, bare.fit.residual)
    written = document(rig, search, found, judgement, rest, regimes, notes, excluded)
    curves = None
    if rig.predict != "effort":
        motion, curves = predicted(search, found)
        written["motion"] = plain(motion)
    return Diagnosis(
        written,
        overlay(search, bare.fit, chosen.fit),
        parameters(search, bare.fit),
        gate.sentence,
        laws(search.heldout, chosen.effects, chosen.fit.changes, search.heldout.sizes.axis_unit),
        curves,
    )


def _stroke(recordings: list[Recording]) -> float:
    return float(np.ptp(np.concatenate([p.q[p.use] for r in recordings for p in r.pieces])))


def _ceiling(search: Search, model: Model) -> Ceiling:
    problems = search.train, search.heldout
    return ceiling(*problems, model.fit.residual, model.heldout, search.models.folds)
