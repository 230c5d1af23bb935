"""From what is left of a rig's logs to a law that was fitted in full, and how it reads.

The law is composed to first order, written, and loaded again as the effect file that it is; what is
told of it is what that file does: fitted together with the model, it has to pass the questions that
every effect has to pass.
"""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from spirob.diagnosis.model import Found, Model
from spirob.effects import Effect, load_file
from spirob.effects.motor.coulomb_friction import CoulombFriction
from spirob.identify.descent import slopes_ahead
from spirob.identify.intervals import Estimate, block_covariance
from spirob.identify.scaling import Scaling
from spirob.machine.composed.draft import Draft
from spirob.machine.composed.greedy import compose
from spirob.machine.composed.ground import ground_of
from spirob.machine.composed.law import Law, law_of
from spirob.machine.composed.writing import Units, formula, told, written
from spirob.machine.inverse.kernel_loop import LEAST
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.page_tables import laws, without
from spirob.machine.search.foretold import foretells
from spirob.machine.search.models import STEP, Models, RigSearch

NAME = "law"
SURE = 1.96  # deviations of a 95 % interval


@dataclass(frozen=True)
class Composed:
    """A law that takes what counts of what a model leaves.

    document  plain data, as `diagnosis.json` holds it
    text      of its effect file
    drawing   rows of held-out samples: as `shown.laws`, with `band`, half the 95 % interval
    model     fitted, with the law as its last effect
    """

    document: dict[str, Any]
    text: str
    drawing: pd.DataFrame
    model: Model

    @property
    def terms(self) -> int:
        """How many terms it has."""
        return len(self.document["terms"])


@dataclass(frozen=True)
class _Fitted:
    """A law as the file that it is, fitted beside a model."""

    law: Law
    name: str
    effect: type[Effect]
    models: Models
    model: Model

    def only(self, parts: Sequence[int], beside: "_Beside") -> Model:
        """The model with these parts of the law alone."""
        silent = [f"{self.name}.{n}" for k in range(self.law.terms) for n in self.law.fields(k)]
        kept = {f"{self.name}.{n}" for k in parts for n in self.law.fields(k)}
        effects = (*beside.base.effects, self.effect)
        return self.models.without(
            [n for n in silent if n not in kept], effects, self.model.fit.changes
        )

    def weakest(self, model: Model, kept: Sequence[int]) -> int:
        """The part of these without which the others of a model leave least, to first order."""
        names, slopes = list(model.fit.estimates), model.fit.jacobian
        scaling, changes = Scaling(self.models.train.table, names), model.fit.changes

        def left(k: int) -> float:
            own = {f"{self.name}.{field}" for field in self.law.fields(k)}
            none = changes | {f"{self.name}.amplitude_{k + 1}": 0.0}
            away = slopes @ (scaling.scaled(none) - scaling.scaled(changes))
            after, rest = model.fit.residual + away, slopes[:, [n not in own for n in names]]
            moved = np.linalg.lstsq(rest, after, rcond=None)[0]
            return float(np.sum((after - rest @ moved) ** 2))

        return min(kept, key=left)


def composed(
    search: RigSearch,
    found: Found,
    base: Model,
    wanted: Callable[[Draft], bool] = lambda draft: True,
) -> Composed | None:
    """The law of what `base` leaves; None where no term is needed, or the file does not hold.

    It has to explain what no set of effects explains: not the model alone, and not the one that the
    search chose, likely or not.  Where the better of a law beside the drive and one on it does not
    do so once it is fitted in full, the other is asked.

    wanted  whether a law drafted so is to be fitted in full
    """
    for drafts, draft in compose(ground_of(search, list(base.fit.estimates), base.fit.changes)):
        if not wanted(draft):
            continue
        law = law_of(draft, drafts.ranges, search.models.train.sizes.torque)
        with tempfile.TemporaryDirectory(prefix="spirob-law-") as folder:
            beside = _Beside(search, base, drafts.ground.changes, _first(found), Path(folder))
            one = _pruned(beside, law)
            if _stands(search, (base, found.chosen), one):
                return _told(search, found, base, one)
    return None


def _stands(search: RigSearch, others: Sequence[Model], one: _Fitted) -> bool:
    """Whether a law explains what these models do not.

    Of a drive's, enough of a strong effort is left, and it foretells the effort.

    others  the model beside which it was composed, then any more
    """
    worth, model = search.worth, one.model
    if one.law.of_drive and not (_drives(one) and foretells(one.models, model, others[0])):
        return False
    return all(worth.matters(m, model) and not worth.denied(m, model) for m in others)


def _drives(one: _Fitted) -> bool:
    """Whether a law leaves as much of a strong effort as can be told from none.

    A scale that grows as the law takes would explain any effort: what is left is counted in it.
    Nor does a term of it take or give more than all: such ones only cancel one another.
    """
    problem, changes = one.models.train, one.model.fit.changes
    made = np.abs(problem.read(changes)["motor.current"])
    strong = made > np.sqrt(np.mean(made**2))
    sizes = [f"{one.name}.amplitude_{k + 1}" for k in range(one.law.terms)]
    without = [changes | {n: 0.0 for n in sizes if n != own} for own in sizes]
    left, *each = (
        float(np.mean(problem.passed(one.effect, at)[strong])) for at in (changes, *without)
    )
    return left > LEAST and all(abs(1.0 - alone) <= 1.0 for alone in each)


@dataclass(frozen=True)
class _Beside:
    """What a law is fitted beside: the model, where its numbers begin, and room for files.

    rival  that the files name until the nearest effect is known
    """

    search: RigSearch
    base: Model
    start: dict[str, float]
    rival: type[Effect]
    folder: Path


def _pruned(beside: _Beside, law: Law) -> _Fitted:
    """The law, fitted in full, without terms that then no longer matter beside the others."""
    worth, whole = beside.search.worth, _fitted(beside, law, "whole")
    kept, one = list(range(law.terms)), whole.model
    while len(kept) > 1:
        others = [k for k in kept if k != whole.weakest(one, kept)]
        lesser = whole.only(others, beside)
        if worth.matters(lesser, one) and not worth.denied(lesser, one):
            break
        kept, one = others, lesser
    return whole if len(kept) == law.terms else _fitted(beside, whole.law.only(kept), "pruned")


def _fitted(beside: _Beside, law: Law, where: str) -> _Fitted:
    """A law written, loaded and fitted together with a model."""
    search, name = beside.search, _name(beside.search)
    path = beside.folder / where / f"{name}.py"
    path.parent.mkdir()
    known = search.models
    path.write_text(written(law, told(law, known.train.sizes), beside.rival), encoding="utf-8")
    (effect,) = load_file(path).values()
    train, heldout = (problem.beside(effect) for problem in (known.train, known.heldout))
    models = Models(train, heldout, known.names)
    models.progress = search.progress
    start = beside.start | law.changes(name)
    model = models.fitted((*beside.base.effects, effect), start)
    own = {n.split(".", 1)[1]: e.value for n, e in model.fit.estimates.items() if _of(n, name)}
    return _Fitted(law.at(own), name, effect, models, model)


def _told(search: RigSearch, found: Found, base: Model, one: _Fitted) -> Composed:
    """What a reader gets of a law."""
    law, model, sizes = one.law, one.model, search.models.train.sizes
    problems = one.models.train, one.models.heldout
    own = {n.split(".", 1)[1]: e for n, e in model.fit.estimates.items() if _of(n, one.name)}
    bare = problems[0](without(one.effect, model.fit.changes, problems[0]))
    shown = problems[0].added(one.effect, model.fit.changes, bare)
    nearest, alike = _nearest(search, found, base, shown)
    title = told(law, sizes)
    share = 1.0 - model.heldout_square / base.heldout_square
    rows = laws(problems[1], [one.effect], model.fit.changes, sizes.axis_unit)
    rows["band"] = _band(problems, model, one.name)
    rmse = {"train": float(np.sqrt(np.mean(model.fit.residual**2)))}
    rmse["test"] = float(np.sqrt(model.heldout_square))
    document = document_of(law, one.name, title, sizes, own, share, rmse, (nearest, alike))
    return Composed(document, written(law, title, nearest, own), rows, model)


def document_of(
    law: Law,
    name: str,
    title: str,
    units: Units,
    own: Mapping[str, Estimate],
    share: float,
    rmse: Mapping[str, float],
    nearest: tuple[type[Effect], float],
) -> dict[str, Any]:
    """What `diagnosis.json` holds of a law.

    title    what shape it has;  own  its fitted numbers by field
    share    of the squared error held out that it takes;  rmse  that it leaves, by role
    nearest  effect of the library that resembles it most, and the share of the law that it makes
    """
    rival, alike = nearest
    return {
        "file": f"{name}.py",
        "sentence": (
            f"A law of this shape takes {share:.0%} of the squared error that is left, held out: "
            f"{title}. Nearest of the library: {rival.title} ({alike:.0%} of the law)."
        ),
        "shape": title,
        "formula": formula(law, units),
        "terms": [" × ".join(part.term.kinds) for part in law.parts],
        "numbers": {field: e.plain for field, e in own.items()},
        "share": share,
        "rmse": dict(rmse),
        "dissipative": law.brakes,
        "nearest": {"name": rival.name(), "title": rival.title, "share": alike},
        "range": {a: list(ends) for a, ends in law.ranges.taught().items() if a in law.reads()},
    }


def _name(search: RigSearch) -> str:
    """A name that no effect of the model has."""
    return free_name({e.name() for e in search.models.train.effects})


def free_name(taken: set[str]) -> str:
    """The name of a new law beside these effects."""
    k = 1
    while (name := NAME if k == 1 else f"{NAME}_{k}") in taken:
        k += 1
    return name


def _of(full: str, owner: str) -> bool:
    return full.split(".", 1)[0] == owner


def _nearest(
    search: RigSearch, found: Found, base: Model, law: np.ndarray
) -> tuple[type[Effect], float]:
    """The effect of the library that makes most of the law, (N,), and the share that it makes.

    Beside what the fitted numbers can make of either.
    """
    slopes = base.fit.jacobian / (np.linalg.norm(base.fit.jacobian, axis=0) + 1e-300)
    span = np.linalg.qr(slopes)[0]

    def beside(values: np.ndarray) -> np.ndarray:
        return np.asarray(values - span @ (span.T @ values))

    own, best = beside(law), (_first(found), 0.0)
    for offer in found.offers:
        point = {**base.fit.changes, **offer.values}
        other = beside(search.models.train.added(offer.effect, point, base.fit.residual))
        power = float(np.dot(other, other) * np.dot(own, own))
        alike = float(np.dot(own, other) ** 2 / power) if power > 0.0 else 0.0
        best = max(best, (offer.effect, alike), key=lambda pair: pair[1])
    return best


def _first(found: Found) -> type[Effect]:
    """The best of the library alone; dry friction where nothing of it is a candidate."""
    return found.offers[0].effect if found.offers else CoulombFriction


def _band(problems: tuple[InverseProblem, InverseProblem], model: Model, name: str) -> np.ndarray:
    """Half the 95 % interval of the law on the held-out trials, (M,)."""
    train, held = problems
    names = list(model.fit.estimates)
    scaling = Scaling(held.table, names)
    known = set(names)
    fixed = {n: v for n, v in model.fit.changes.items() if n not in known}
    at = scaling.scaled(model.fit.changes)
    slopes = slopes_ahead(held, scaling, at, fixed, model.heldout, STEP)
    robust = 1e3 * float(np.sqrt(np.mean(train.measured() ** 2)))
    spread = block_covariance(
        model.fit.jacobian, model.fit.residual, train.edges, robust, train.block
    )
    own = [k for k, full in enumerate(names) if _of(full, name)]
    part = spread[np.ix_(own, own)]
    variance = np.einsum("ij,jk,ik->i", slopes[:, own], part, slopes[:, own])
    return SURE * np.sqrt(np.maximum(variance, 0.0))
