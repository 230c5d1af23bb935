"""The arm's own search (`spirob.diagnosis`) on logs from elsewhere, with document and page."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import pandas as pd

from spirob.diagnosis.atlas import survey
from spirob.diagnosis.certainty import Ended
from spirob.diagnosis.criteria import Settings, noise_floor
from spirob.diagnosis.document import document
from spirob.diagnosis.fitting import Begun, begun
from spirob.diagnosis.followup import asked
from spirob.diagnosis.model import Model, label
from spirob.diagnosis.simulated import Simulated
from spirob.diagnosis.verdict import Verdict
from spirob.diagnosis.verdict import searched as searched_for
from spirob.effects import Effect, all_effects
from spirob.identify.builds import TOLERANCES, Floor
from spirob.identify.fit import STEPS, fit_identifiable
from spirob.identify.intervals import with_bounds
from spirob.identify.measurement import Measurement
from spirob.identify.problem import effort_rms
from spirob.identify.residual import SENSE, SUSPECTS, Filter, Residual, explained
from spirob.logs.readers import Table
from spirob.machine.arm.description import ArmFile, described
from spirob.machine.arm.preparation import Settled, settled, settled_with
from spirob.machine.arm.replay import arm_trial, barely_moves, lasting
from spirob.machine.arm.rows import block, roles
from spirob.machine.arm.shape import SHAPE
from spirob.machine.loading import chosen
from spirob.plant import Plant
from spirob.robot import MOTORS


def read(
    rig: ArmFile, train: Sequence[Table], test: Sequence[Table]
) -> tuple[dict[str, list[Measurement]], list[str]]:
    """The logs by role, and what was repaired in them."""
    tables = [*train, *test]
    parts, divided = roles(range(len(train)), range(len(train), len(tables)))
    logs = [arm_trial(table, rig, "train") for table in tables]
    trials = {
        role: [replace(block(logs[part.log][0], part), role=role) for part in of]
        for role, of in parts.items()
    }
    said = [text for _, texts in logs for text in texts]
    names = ", ".join(t.name for t in trials["validate"])
    chosen = f"Effects are chosen by {names}, which no fit has seen."
    return trials, [*said, *barely_moves([log for log, _ in logs], rig), *divided, chosen]


@dataclass(frozen=True)
class Searched:
    """A search that ended and its verdict, with the floor that it stood on."""

    ended: Ended
    verdict: Verdict
    floor: Floor

    @property
    def models(self) -> Simulated:
        """What was fitted."""
        return self.ended.search.models  # type: ignore[no-any-return]

    @property
    def stands(self) -> Model:
        """The model that stands: with what was named, or the fitted numbers alone."""
        return self.ended.found.rungs[-1 if self.verdict.kind == "named" else 0]


def searched(
    rig: ArmFile,
    trials: Mapping[str, list[Measurement]],
    settings: Settings,
    progress: Callable[[str], None],
    candidates: Sequence[type[Effect]] | None = None,
    own: Sequence[type[Effect]] | None = None,
    said: list[str] | None = None,
) -> Searched:
    """The search on these trials; candidates are those of the library where none are given.

    own   the effects that the model holds, where they are found already
    said  gets sentences about the arm's shape and what of the logs does not count

    Raises ConfigError where `fit` or `known` names no number of the model, or goes beyond its
    bounds.
    """
    own = chosen(rig.effects) if own is None else own
    library = list(all_effects().values()) if candidates is None else list(candidates)
    absent = [e for e in library if e not in own]
    for unseen in [e for e in absent if e.port in _unseen(rig)]:
        absent.remove(unseen)
        progress(f"{unseen.name()} is no candidate: {_unseen(rig)[unseen.port]}")
    plant = described(Plant(rig.machine(), [*own, *absent]), rig, own)
    held = [f"{e.name()}.{f}" for e in own for f in e.fitted()]
    start = {n: plant.table.about[n].nominal for n in held if n not in rig.known}
    names = list(dict.fromkeys([*rig.fitted(), *start]))
    rows = Filter(cutoff=rig.filter.cutoff, every=rig.filter.decimate)
    residuals = {role: Residual(plant, found, rows) for role, found in trials.items()}
    # who says what is fitted has said that the rest is as it is
    free = (
        []
        if "fit" in rig.model_fields_set
        else [n for n in (*SHAPE, *TOLERANCES) if n not in rig.known]
    )
    asked = Asked(residuals, names, absent, free, settings, progress)
    ground = settled(residuals, names, start, free, settings, progress)
    found = asked.searched(ground, ground.numbers)
    if free and not found.verdict.doubts:
        if found.verdict.kind == "unknown":
            ground, found = asked.with_contender(ground, found)
        elif found.verdict.named and not ground.as_drawn:
            ground, found = asked.with_named(ground, found)
    if said is not None:
        said += ground.said
    return found


@dataclass(frozen=True)
class Asked:
    """The logs by role, names of the usual numbers, candidates, and numbers of a shape that may be
    searched for."""

    residuals: Mapping[str, Residual]
    names: Sequence[str]
    absent: Sequence[type[Effect]]
    free: Sequence[str]
    settings: Settings
    progress: Callable[[str], None]

    def searched(
        self, ground: Settled, bare: Mapping[str, float], effects: Sequence[type[Effect]] = ()
    ) -> Searched:
        """The search on the rows that count.

        bare  numbers without an effect;  effects  of a model whose numbers the ground has
        """
        known = replace(self.settings, floor=max(self.settings.floor, ground.floor.share))
        start = _begun(replace(ground, numbers=dict(bare)), self.names, known)
        models = Simulated(ground.residuals, self.names, known, start)
        if effects:
            models.fitted(tuple(effects), ground.numbers)
        doubts = _doubts(models)
        ended, verdict = searched_for(models, self.absent, known, self.progress, doubts)
        return Searched(ended, verdict, ground.floor)

    def with_contender(self, ground: Settled, found: Searched) -> tuple[Settled, Searched]:
        """The same with the arm's shape that of the best model with an effect, if that is named.

        A strong effect may bend the arm into a shape that no fit without it has.
        """
        single = [m for m in found.models.tried.values() if len(m.effects) == 1]
        if not single:
            return ground, found
        other, again = self._shaped(ground, min(single, key=lambda m: m.mean_square))
        return (other, again) if again.verdict.named else (ground, found)

    def with_named(self, ground: Settled, found: Searched) -> tuple[Settled, Searched]:
        """The same with a shape that was found beside the named effects, if they stay.

        What was found without them holds a part of what they do, and they the rest.
        """
        other, again = self._shaped(ground, found.ended.found.chosen)
        same = set(again.verdict.named) == set(found.verdict.named)
        return (other, again) if same else (ground, found)

    def _shaped(self, ground: Settled, model: Model) -> tuple[Settled, Searched]:
        """The shape of the arm by the fit of a model with effects, and the search in it."""
        self.progress(f"the arm's shape once more, with {label(model.effects)}")
        other = settled_with(self.residuals, model.fit, self.free, self.settings, self.progress)
        return other, self.searched(other, ground.numbers, model.effects)


def _begun(ground: Settled, names: Sequence[str], settings: Settings) -> Begun:
    """The fit of the numbers alone; beside another shape they were just fitted."""
    train, start = ground.residuals["train"], ground.numbers
    if ground.as_drawn:
        return begun(train, names, start, settings, STEPS[-1:])
    scale, patience = settings.scale, settings.patience
    steps = STEPS[-1:]
    return Begun(*fit_identifiable(train, names, start, scale, patience, steps=steps, exact=False))


def _unseen(rig: ArmFile) -> dict[str, str]:
    """Ports at which an effect does not show in such logs, and why."""
    found = {"sensing.frame": "motion and current are as old as each other"}
    if all(of.command is None for of in rig.motors().values()):
        found["command.current"] = "the logs do not tell how the motors were commanded"
    return found


def written(rig: ArmFile, found: Searched, said: list[str]) -> dict[str, Any]:
    """What `diagnosis.json` holds, with the keys of any rig's."""
    models, ended, verdict = found.models, found.ended, found.verdict
    train, bare = models.train, ended.found.rungs[0]
    where = survey(train, bare.fit.changes, bare.fit.residual[train.rows])
    question = asked(ended, verdict)
    further = question.decide or question.prove
    told = document(ended, verdict, where, noise_floor(train), further)
    roles = {"train": "train", "test": "heldout"}
    return {
        **told,
        "floor": asdict(found.floor),
        "rig": rig.name,
        "predict": "effort",
        "effort": train.effort.name,
        "effort_rms": {shown: effort_rms(models.residuals[r]) for shown, r in roles.items()},
        "ladder": [_tested(rung) for rung in told["ladder"]],
        "repairs": [*said, *_strangers(models)],
        "excluded": {},
        "numbers": {n: e.plain for n, e in ended.found.chosen.fit.estimates.items()},
        "model": _standing(rig, found),
        "motion": None,
    }


def _standing(rig: ArmFile, found: Searched) -> dict[str, Any]:
    """The model that stands, as another program needs it; see `spirob.machine.document`."""
    last, plant = found.stands, found.models.train.plant
    values = dict(
        zip(plant.table.names, plant.table.vector(last.fit.changes).tolist(), strict=True)
    )
    there = [
        e
        for e in plant.effects
        if any(values[f"{e.name()}.{f}"] != neutral for f, neutral in e.neutral.items())
    ]
    owners = {name for name, _ in plant.rig.parts()} | {e.name() for e in there}
    return {
        "format": 1,
        "machine": "arm",
        "rig": rig.arm,
        "effects": [e.name() for e in there],
        "changes": {n: v for n, v in values.items() if n.partition(".")[0] in owners},
        "trials": lasting(found.models.heldout.trials),
    }


def _doubts(models: Simulated) -> list[str]:
    """Why no name can be trusted: the fitted numbers explain too little of the current."""
    scores = models.scores(models.fitted((), {}))
    least = min(scores[role].r2 for role in ("validate", "heldout"))
    if least >= SENSE:
        return []
    return [
        f"With fitted numbers the arm's model explains {max(0.0, least):.0%} of the current's "
        f"variance: {SUSPECTS}"
    ]


def _strangers(models: Simulated) -> list[str]:
    """A sentence for each log whose currents do not follow from its motion."""
    missed = models.missed(models.fitted((), {}))
    return [
        f"{name}: with fitted numbers the arm's model explains {max(0.0, r2):.0%} of its current's "
        f"variance: {SUSPECTS}"
        for role, residual in models.residuals.items()
        for name, r2 in explained(residual, missed[role]).items()
        if r2 < SENSE
    ]


def _tested(rung: dict[str, Any]) -> dict[str, Any]:
    """A rung in the words of any rig's: the held-out logs are those given to test."""
    intervals = rung["interval"]
    return {
        **rung,
        "test": rung["heldout"],
        "interval": {**intervals, "test": intervals["heldout"]},
    }


PAGE_ROLES = {"heldout": "test", "train": "train"}


def overlay(found: Searched) -> pd.DataFrame:
    """Current of each working motor, measured and modelled: bare, and with the named effects."""
    models = {"base": found.ended.found.rungs[0], "named": found.stands}
    parts = []
    for role, shown in PAGE_ROLES.items():
        residual = found.models.residuals[role]
        for k, trial in enumerate(residual.trials):
            played = {n: residual.respond(m.fit.changes, k) for n, m in models.items()}
            for m in residual.driven(trial):
                columns: dict[str, Any] = {"trial": trial.name, "role": shown}
                columns["time"] = trial.seconds[residual.cycles(trial)]
                columns["position"] = residual.thin(trial.displacement[:, m], trial)
                columns["measured"] = residual.thin(trial.current[:, m], trial)
                columns |= {n: residual.thin(r.current[:, m], trial) for n, r in played.items()}
                parts.append(pd.DataFrame(columns).assign(motor=MOTORS[m]))
    return pd.concat(parts, ignore_index=True)


def parameters(found: Searched) -> dict[str, Any]:
    """Fitted numbers of the bare model."""
    return with_bounds(found.ended.found.rungs[0].fit.estimates, found.models.train.table)
