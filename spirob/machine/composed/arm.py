"""From what the arm's model leaves in the motor currents to a law that was played in full.

As for a rig (`composing`); what a law is worth the whole coupled model says, by the questions of
the arm's own search.
"""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from spirob.diagnosis.criteria import Settings, Worth
from spirob.diagnosis.fitting import parameters_of, roughly
from spirob.diagnosis.model import Model
from spirob.diagnosis.simulated import modelled, scores
from spirob.effects import Effect, all_effects, load_file
from spirob.effects.effect import SUFFIX
from spirob.effects.replay import contribution
from spirob.errors import SimulationError
from spirob.identify.descent import slopes_ahead
from spirob.identify.fit import STEPS
from spirob.identify.intervals import Estimate, block_covariance
from spirob.identify.problem import effort_rms
from spirob.identify.residual import Residual
from spirob.identify.scaling import Scaling
from spirob.machine.composed.composing import SURE, Composed, document_of, free_name
from spirob.machine.composed.greedy import compose
from spirob.machine.composed.ground import PLACES, Ground, arm_ground, lean, turn_of
from spirob.machine.composed.law import Law, law_of
from spirob.machine.composed.writing import told, written
from spirob.machine.page_tables import laws

PORT = "motor.torque"
# of what the whole law takes, and of the floor: what each of its terms takes beside the others
FURTHER, LESSER = 0.25, 0.5


@dataclass(frozen=True)
class Rival:
    """The best that the search found, likely or not: RMSE by role, and how many effects."""

    errors: Mapping[str, float]
    effects: int


@dataclass(frozen=True)
class _Units:
    """The arm's: SI, the place in its own unit."""

    place: str
    torque_unit: str = "N·m"

    def unit(self, unit: str) -> str:
        return self.place if unit == "m" else unit


@dataclass(frozen=True)
class _Fitted:
    """A law as the file that it is, fitted in the coupled model; `ground` taught it.

    start  numbers of both, as they were composed
    """

    ground: Ground
    law: Law
    effect: type[Effect]
    residuals: dict[str, Residual]
    start: dict[str, float]
    model: Model

    @property
    def own(self) -> dict[str, Estimate]:
        """Its fitted numbers by field."""
        numbers = self.model.fit.estimates
        return {n.partition(".")[2]: e for n, e in numbers.items() if _is_of(n, self.effect)}


def composed_for_arm(
    residuals: Mapping[str, Residual],
    names: Sequence[str],
    changes: Mapping[str, float],
    rival: Rival,
    settings: Settings,
    progress: Callable[[str], None] = lambda text: None,
) -> Composed | None:
    """The law of what a model leaves; None where none is needed, none holds, or none can be played.

    residuals  by role, of a plant that may hold more effects than the model
    names      of its fitted numbers;  changes  all that are not those of the table
    rival      which the law has to outdo
    """
    bare = {role: lean(problem, changes, []) for role, problem in residuals.items()}
    changes = {n: v for n, v in changes.items() if n in bare["train"].table.index}
    ends = [_drafted(bare, names, changes, p, settings, progress) for p in PLACES]
    drafted = [one for one in ends if one is not None]
    if not drafted:
        return None
    ground, law, _ = min(drafted, key=lambda one: one[2])
    # fitted as far as with a law: what only that gains is the law's
    below = modelled([], roughly(bare["train"], names, changes, settings), bare)
    with tempfile.TemporaryDirectory(prefix="spirob-law-") as folder:
        progress(f"the arm plays a law of {law.terms} terms")
        try:
            whole = _fitted(ground, law, bare, names, settings, Path(folder))
            one = _pruned(whole, below, bare, names, settings, Path(folder))
        except SimulationError as wrong:  # to first order a law may be one that throws the arm
            progress(f"no model of the arm can hold it: {wrong}")
            return None
        if not _holds(one, below, rival, settings):
            return None
        return _told(one, below)


def _drafted(
    bare: Mapping[str, Residual],
    names: Sequence[str],
    changes: Mapping[str, float],
    place: str,
    settings: Settings,
    progress: Callable[[str], None],
) -> tuple[Ground, Law, float] | None:
    """The law of this place, and the mean square that it leaves of the folds left out."""
    train = bare["train"]
    ground = arm_ground(train, bare["validate"], names, changes, place, settings, progress)
    drafts = compose(ground)
    if not drafts:
        return None
    _, draft = drafts[0]
    table = train.table
    constant = table.vector(changes)[table.position("motor.torque_constant")]
    law = law_of(draft, ground.ranges, float(constant) * effort_rms(train))
    return ground, law, draft.mean_square


def _fitted(
    ground: Ground,
    law: Law,
    bare: Mapping[str, Residual],
    names: Sequence[str],
    settings: Settings,
    folder: Path,
) -> _Fitted:
    """A law written, loaded and fitted in the coupled model."""
    name = free_name({e.name() for e in bare["train"].plant.effects} | set(all_effects()))
    rival = next(iter(_rivals()))
    path = folder / f"{name}.py"
    path.write_text(written(law, told(law, _Units(law.ranges.unit)), rival), encoding="utf-8")
    (effect,) = load_file(path).values()
    residuals = {role: lean(p, ground.changes, [effect]) for role, p in bare.items()}
    start = ground.changes | law.changes(name)
    both = [*names, *parameters_of(effect)]
    model = _model(effect, residuals, both, [start], settings)
    return _Fitted(ground, law, effect, residuals, start, model)


def _model(
    effect: type[Effect],
    residuals: Mapping[str, Residual],
    names: Sequence[str],
    starts: Sequence[Mapping[str, float]],
    settings: Settings,
) -> Model:
    """The model with the law, from where its fit ends lowest."""
    fits = [roughly(residuals["train"], names, start, settings) for start in starts]
    found = min(fits, key=lambda one: one.cost)
    return modelled([effect], found, residuals)


def _pruned(
    whole: _Fitted,
    below: Model,
    bare: Mapping[str, Residual],
    names: Sequence[str],
    settings: Settings,
    folder: Path,
) -> _Fitted:
    """The law without terms that do not matter beside the others, as effects beside another."""
    model, kept = whole.model, list(range(whole.law.terms))
    size = float(np.sqrt(max(0.0, below.mean_square - model.mean_square)))
    least = max(LESSER * settings.floor * effort_rms(bare["validate"]), FURTHER * size)
    worth = Worth(settings, least)
    while len(kept) > 1:
        others = {k: [j for j in kept if j != k] for k in kept}
        lesser = {k: _only(whole, rest, names, model, settings) for k, rest in others.items()}
        weak = [
            k
            for k, one in lesser.items()
            if not worth.matters(one, model) or _heldout(model) >= _heldout(one)
        ]
        if not weak:
            break
        out = min(weak, key=lambda k: lesser[k].mean_square)
        kept, model = [k for k in kept if k != out], lesser[out]
    if len(kept) == whole.law.terms:
        return whole
    changes = model.fit.changes
    found = {n.partition(".")[2]: v for n, v in changes.items() if _is_of(n, whole.effect)}
    without = {n: v for n, v in changes.items() if not _is_of(n, whole.effect)}
    ground = replace(whole.ground, changes=without)
    (folder / "pruned").mkdir()
    return _fitted(ground, whole.law.at(found).only(kept), bare, names, settings, folder / "pruned")


def _only(
    whole: _Fitted, kept: Sequence[int], names: Sequence[str], model: Model, settings: Settings
) -> Model:
    """The model with some terms of the law alone.

    A fit with the others may have ended where none leads on: it begins there, and as composed.
    """
    name, law = whole.effect.name(), whole.law
    own = [f"{name}.{f}" for k in kept for f in law.fields(k)]
    known = set(parameters_of(whole.effect))
    own += [n for n in (f"{name}.amplitude_{k + 1}{SUFFIX}" for k in kept) if n in known]
    silent = {f"{name}.amplitude_{k + 1}" for k in range(law.terms) if k not in kept}
    starts = [
        {n: v for n, v in start.items() if n not in silent}
        for start in (model.fit.changes, whole.start)
    ]
    return _model(whole.effect, whole.residuals, [*names, *own], starts, settings)


def _holds(one: _Fitted, below: Model, rival: Rival, settings: Settings) -> bool:
    """Whether the law counts, beside the numbers alone and beside the best of the library.

    Beside a set that is no plainer it has to be better, beside a plainer one by a size that counts.
    """
    least = settings.floor * effort_rms(one.residuals["validate"])
    worth = Worth(settings, least)
    if not worth.matters(below, one.model) or worth.denied(below, one.model):
        return False
    found = scores(one.model, one.residuals)
    own, other = found["validate"].rmse ** 2, rival.errors["validate"] ** 2
    plainer = one.law.terms <= rival.effects
    if own > (1.0 - settings.better) * other if plainer else other - own < least**2:
        return False
    return found["heldout"].rmse ** 2 <= (1.0 - settings.veto) * rival.errors["heldout"] ** 2


def _heldout(model: Model) -> float:
    return float(np.sqrt(model.heldout_square))


def _told(one: _Fitted, below: Model) -> Composed:
    """What a reader gets of a law."""
    law, units = (
        one.law.at({f: e.value for f, e in one.own.items()}),
        _Units(one.ground.ranges.unit),
    )
    title, nearest = told(law, units), _nearest(one)
    if any(e.low > 0.0 or e.high < 0.0 for f, e in one.own.items() if f.endswith(SUFFIX)):
        title += ", of another size in each motor"
    rows = _drawn(one)
    share = 1.0 - (_heldout(one.model) / _heldout(below)) ** 2
    found = scores(one.model, one.residuals)
    rmse = {"train": found["train"].rmse, "test": found["heldout"].rmse}
    document = document_of(law, one.effect.name(), title, units, one.own, share, rmse, nearest)
    return Composed(document, written(law, title, nearest[0], one.own), rows, one.model)


def _drawn(one: _Fitted) -> pd.DataFrame:
    """Rows of held-out samples, over the place of the law: a length, or the angle of the motor."""
    heldout, ranges = one.residuals["heldout"].unweighted(), one.ground.ranges
    rows = laws(heldout, [one.effect], one.model.fit.changes, ranges.unit)
    if ranges.unit == "rad":
        rows["position"] = np.concatenate([p.angle for p in heldout.stretches()])  # type: ignore[misc]
        rows["velocity"] *= turn_of(heldout)
    rows["band"] = _band(one)
    return rows


def _rivals() -> list[type[Effect]]:
    """The effects of the library that act where a law does."""
    return [e for e in all_effects().values() if e.port == PORT]


def _nearest(one: _Fitted) -> tuple[type[Effect], float]:
    """The effect of the library that makes most of the law's current, and the share that it makes.

    At its nominal shape, along the motion that taught the law, beside what the fitted numbers make.
    """
    side = one.ground.train
    span = np.linalg.qr(side.slopes / (np.linalg.norm(side.slopes, axis=0) + 1e-300))[0]
    ranges, signals = one.ground.ranges, side.track.signals
    seen = {
        ranges.position: signals["place"],
        "motor.speed": signals["speed"],
        "motor.load_torque": signals["load"],
        "time": signals["time"],
    }

    def current(effect: type[Effect], numbers: Mapping[str, float]) -> np.ndarray:
        parts = [
            contribution(
                effect,
                numbers,
                {"motor.rest_speed": ranges.rest_speed, **{n: v[a:b] for n, v in seen.items()}},
                float(step),
            )
            for a, b, step in zip(
                side.track.starts, side.track.starts[1:], side.track.steps, strict=False
            )
        ]
        values = side.shown(np.concatenate(parts))
        return np.asarray(values - span @ (span.T @ values))

    own = current(one.effect, {f: e.value for f, e in one.own.items()})
    best: tuple[type[Effect], float] = (_rivals()[0], 0.0)
    known = {*seen, "motor.rest_speed"}
    for effect in _rivals():
        if set(effect.reads.values()) <= known:
            other = current(effect, {})
            power = float(np.dot(other, other) * np.dot(own, own))
            alike = float(np.dot(own, other) ** 2 / power) if power > 0.0 else 0.0
            best = max(best, (effect, alike), key=lambda pair: pair[1])
    return best


def _band(one: _Fitted) -> np.ndarray:
    """Half the 95 % interval of the law's current on the held-out trials, (M,)."""
    train, found = one.residuals["train"], one.model.fit
    held = one.residuals["heldout"].unweighted()
    scaling = Scaling(held.table, list(found.estimates))
    fixed = {n: v for n, v in found.changes.items() if n not in found.estimates}
    at = scaling.scaled(found.changes)
    slopes = slopes_ahead(held, scaling, at, fixed, held(found.changes), STEPS[-1])[held.rows]
    robust = 1e3 * effort_rms(train)
    spread = block_covariance(found.jacobian, found.residual, train.edges, robust, train.block)
    own = [k for k, n in enumerate(found.estimates) if _is_of(n, one.effect)]
    variance = np.einsum("ij,jk,ik->i", slopes[:, own], spread[np.ix_(own, own)], slopes[:, own])
    return np.asarray(SURE * np.sqrt(np.maximum(variance, 0.0)))


def _is_of(full: str, effect: type[Effect]) -> bool:
    return full.partition(".")[0] == effect.name()
