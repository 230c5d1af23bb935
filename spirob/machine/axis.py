"""The diagnosis of a plain rig from its recordings: check, fit, search, judge."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from spirob.diagnosis.atlas import atlas
from spirob.diagnosis.criteria import Criteria
from spirob.diagnosis.flexible import one_thread
from spirob.diagnosis.model import Model
from spirob.diagnosis.schema import checked
from spirob.diagnosis.search import Found, Search
from spirob.diagnosis.verdict import TWICE, concluded, judge
from spirob.effects import Effect, all_effects
from spirob.errors import ConfigError
from spirob.identify.identifiability import Identifiability, probe
from spirob.machine.body import RigidBody
from spirob.machine.candidates import applicable, with_room
from spirob.machine.composed import Composed, composed
from spirob.machine.composed.draft import is_bent
from spirob.machine.composed.law import beyond
from spirob.machine.delays import DELAY, as_usual, is_told, partnered, place, widened
from spirob.machine.document import document, heldout, plain, standing
from spirob.machine.flexible import Ceiling
from spirob.machine.inverse import InverseProblem
from spirob.machine.laws import for_axis
from spirob.machine.leftovers import structured
from spirob.machine.loading import chosen, files
from spirob.machine.models import Models, RigSearch
from spirob.machine.motion import without_holds
from spirob.machine.numbers import log_numbers, with_payload
from spirob.machine.page_tables import laws, overlay, parameters, predicted, switches
from spirob.machine.plausibility import (
    AT_LOAD,
    KINDS,
    beyond_bounds,
    doubts,
    fits_at_load,
    may_differ,
    may_sit_at_load,
    oddities,
    released,
)
from spirob.machine.recording import Recording
from spirob.machine.result import Diagnosis
from spirob.machine.rig import Bounded, RigFile
from spirob.machine.scaling import Sizes, sizes_of
from spirob.machine.selection import split


@dataclass(frozen=True)
class _Ready:
    """A rig and its logs, ready to be searched; `said` is what was repaired or left out.

    without   effects that are no candidates;  progress  is told each step
    """

    rig: RigFile
    body: RigidBody | None
    train: list[Recording]
    test: list[Recording]
    own: list[type[Effect]]
    possible: list[type[Effect]]
    excluded: dict[str, str]
    sizes: Sizes
    rest_speed: float
    said: list[str]
    without: Collection[str] = ()
    settings: Criteria = field(default_factory=Criteria)
    progress: Callable[[str], None] = lambda text: None

    def told(self, **changes: Any) -> "_Ready":
        """The same with more told of the rig."""
        return replace(self, rig=self.rig.model_copy(update=changes))


@dataclass(frozen=True)
class _Searched:
    """What a search over a rig's logs ended with; `gate` is what they can say about its numbers."""

    ready: _Ready
    search: RigSearch
    gate: Identifiability
    found: Found

    @property
    def chosen(self) -> Model:
        return self.found.chosen


def diagnose_recordings(
    rig: RigFile,
    folder: Path,
    train: list[Recording],
    test: list[Recording],
    settings: Criteria | None = None,
    progress: Callable[[str], None] = lambda text: None,
    own: Sequence[type[Effect]] | None = None,
    without: Collection[str] = (),
) -> Diagnosis:
    """Diagnose a machine from trials that are read already.

    own      the effects that the model holds, where they are found already
    without  effects that are no candidates, to see what is said where the library lacks them
    """
    if not train:
        raise ConfigError("a diagnosis needs at least one training log")
    held = chosen(files(rig.effects, folder)) if own is None else own
    ready = _ready(rig, folder, train, test, held, without)
    ready = replace(ready, settings=settings or rig.criteria, progress=progress)
    with one_thread():
        done = _searched(_placed(ready))
        if not is_told(rig):
            done = _once_more(done)
        for kind in KINDS:
            if may_differ(kind, rig, done.search, done.chosen):
                kinds = (*(done.ready.rig.per_log or ()), kind)
                told = done.ready.told(per_log=kinds)
                said = f"The logs differ by a number of their own, {kind}: fitted for each."
                done = _better(done, _searched(told), said)
        if may_sit_at_load(rig, done.search, done.chosen):
            told = _at_load(done.ready, held)
            search, gate = _search(told)
            if fits_at_load(search, done.chosen):
                found = search.run()
                if done.search.worth.halves(done.chosen, found.chosen):
                    told = replace(told, said=[*told.said, AT_LOAD])
                    done = _Searched(told, search, gate, found)
        if free := beyond_bounds(done.search, done.chosen):
            progress(f"once more, with {', '.join(free)} set free of its bounds")
            told = replace(done.ready, rig=released(done.ready.rig, free))
            if not is_told(rig):  # it was placed within these bounds
                told = _placed(_without_delay(told))
            done = replace(_searched(told), ready=done.ready)
        return _finish(done)


def base_model(
    rig: RigFile, folder: Path, train: list[Recording], test: list[Recording]
) -> tuple[Search, Model]:
    """The fitted numbers alone, without a search: what a machine leaves that misses no effect."""
    ready = _ready(rig, folder, train, test, chosen(files(rig.effects, folder)), ())
    with one_thread():
        ready = _placed(ready)
        search, _ = _search(ready)
        return search, search.models.fitted((), {})


def _at_load(ready: _Ready, held: Sequence[type[Effect]]) -> _Ready:
    """The same logs, read as those of a sensor at the load."""
    assert ready.rig.position is not None
    told = ready.told(position=ready.rig.position.model_copy(update={"side": "load"}))
    own, possible, excluded = _library(
        told.rig, told.body, told.train, held, told.sizes, told.without
    )
    return replace(told, own=own, possible=possible, excluded=excluded)


def _searched(ready: _Ready) -> _Searched:
    search, gate = _search(ready)
    return _Searched(ready, search, gate, search.run())


def _placed(ready: _Ready) -> _Ready:
    """With a delay between effort and motion to fit, where the description tells nothing of it."""
    if is_told(ready.rig):
        return ready
    search, _ = _search(ready.told(known={**ready.rig.known, "delay": 0.0}))
    ready.progress("effort and motion are laid over one another")
    return _about(ready, _place(search, search.models.fitted((), {})))


def _without_delay(ready: _Ready) -> _Ready:
    fit = {name: bounds for name, bounds in ready.rig.fit.items() if name != "delay"}
    return ready.told(fit=fit)


def _about(ready: _Ready, delay: Bounded) -> _Ready:
    return ready.told(fit={**ready.rig.fit, "delay": delay})


def _place(search: RigSearch, model: Model) -> Bounded:
    return place(search.models.train, model, search.models.folds, search.absent(model))


def _once_more(done: _Searched) -> _Searched:
    """The search about another delay, where something that counts is left and that explains more.

    The effects that were found say more of the delay than any one of the library did: where they
    place it elsewhere and explain more there, or it ended at a bound, it is searched there; where
    they place it nowhere else, within twice as wide bounds if they explain more in these.  The
    usual one is tried where it was none of those looked at: a place found beside coarse shapes of
    laws may be another law's.
    """
    if done.chosen.mean_square < (TWICE * done.search.worth.least) ** 2:
        return done
    fitted, none = done.ready.rig.fit["delay"], as_usual(max(r.period for r in done.ready.train))
    anew, others = _place(done.search, done.chosen), []
    at_bound = done.chosen.fit.estimates[DELAY].at_bound
    if anew != fitted and (at_bound or _fits_better(done, anew)):
        others.append(anew)
    elif anew == fitted and at_bound and _fits_better(done, wider := widened(fitted)):
        others.append(wider)
    if none not in others and (none.low < fitted.low or fitted.high < none.high):
        others.append(none)
    for delay in others:
        done.ready.progress(
            f"once more, with the effort about {1e3 * delay.nominal:.2g} ms after the motion"
        )
        other = _searched(_about(done.ready, delay))
        done = other if done.search.worth.matters(done.chosen, other.chosen) else done
    return done


def _fits_better(done: _Searched, delay: Bounded) -> bool:
    """Whether the chosen effects explain more about another delay."""
    search, _ = _search(_about(done.ready, delay))
    begin = done.chosen.fit.changes | {DELAY: delay.nominal}
    return done.search.worth.matters(done.chosen, search.models.fitted(done.chosen.effects, begin))


def _better(done: _Searched, wider: _Searched, said: str) -> _Searched:
    """What was searched with more told of the rig, where that explains more by what counts."""
    if not done.search.worth.matters(done.chosen, wider.chosen):
        return done
    return replace(wider, ready=replace(wider.ready, said=[*wider.ready.said, said]))


def _ready(
    rig: RigFile,
    folder: Path,
    train: list[Recording],
    test: list[Recording],
    held: Sequence[type[Effect]],
    without: Collection[str],
) -> _Ready:
    repairs = [text for r in [*train, *test] for text in r.said]
    train, test, said = split(train, test)
    repairs += said
    body = None if isinstance(rig.body, str) else RigidBody(rig.body, folder, rig.angular)
    sizes, rest = sizes_of(rig, body, train)
    own, possible, excluded = _library(rig, body, train, held, sizes, without)
    if rig.rows.standstill == "drop" and rig.rows.minimum_speed is None:
        (train, lost), (test, more) = (without_holds(r, rest) for r in (train, test))
        repairs += [*lost, *more]
    return _Ready(rig, body, train, test, own, possible, excluded, sizes, rest, repairs, without)


def _library(
    rig: RigFile,
    body: RigidBody | None,
    train: list[Recording],
    held: Sequence[type[Effect]],
    sizes: Sizes,
    without: Collection[str],
) -> tuple[list[type[Effect]], list[type[Effect]], dict[str, str]]:
    """The laws of the effects that the model holds, of those that may act, why others may not."""
    turned = 0.0 if body or not rig.angular or rig.position is None else _stroke(train)
    side = (rig.position and rig.position.side) or "motor"
    shared = body is None and ("inertia" in rig.fit or rig.known.get("inertia", 0.0) > 0.0)
    own = for_axis(held, turned, side, shared)
    whole = [e for e in all_effects().values() if e.name() not in without]
    library = [*own, *(e for e in for_axis(whole, turned, side, shared) if e not in own)]
    has_tip = not isinstance(rig.body, str) and rig.body.tip is not None
    stiffness = body.stiffness if body else 0.0
    possible, excluded = applicable(library, rig, has_tip, stiffness, rig.angular)
    possible, small = with_room(possible, sizes)
    excluded |= small
    if missing := [e.name() for e in own if e not in possible]:
        raise ConfigError(f"effects: {missing[0]} cannot act here: {excluded[missing[0]]}")
    return own, possible, excluded


def _search(ready: _Ready) -> tuple[Search, Identifiability]:
    """The search over a rig's logs, and what they can say about its numbers."""
    rig = with_payload(ready.rig, ready.sizes)
    fit, held = partnered(rig, ready.train), partnered(rig, ready.test)
    logs = log_numbers(rig, [*fit, *held], ready.sizes)
    fitted = logs.fitted([r.log for r in fit])
    alone = [n for n in logs.fitted([r.log for r in held]) if n not in fitted]
    train, heldout = (
        InverseProblem(rig, ready.body, r, ready.possible, ready.sizes, ready.rest_speed, logs, own)
        for r, own in ((fit, []), (held, alone))
    )
    names = [*(f"rig.{name}" for name in rig.fit), *fitted]
    names += [f"{e.name()}.{f}" for e in ready.own for f in e.fitted()]
    if names in ([], ["rig.delay"]):
        raise ConfigError("fit: name at least one number to fit, such as viscous")
    table = train.table
    asked = [n for n in names if n != "rig.delay"]  # by a sample or two: it cannot be silent
    gate = probe(train, asked, {n: table.about[n].nominal for n in asked})
    shapes = {f"{e.name()}.{f}" for e in ready.own for f in e.fitted() if f not in e.neutral}
    if set(gate.silent) - shapes:  # a shape may say nothing until its amplitude is another
        raise ConfigError(f"fit: {gate.sentence}")
    absent = [e for e in ready.possible if e not in ready.own]
    models = Models(train, heldout, names, ready.settings.floor)
    return Search(models, absent, ready.settings, ready.progress), gate


def _finish(done: _Searched) -> Diagnosis:
    ready, search, found, gate = done.ready, done.search, done.found, done.gate
    problems = search.models.train, search.models.heldout
    ended, weighed = concluded(search, found, lambda model: is_bent(search, model))
    found = ended.found
    bare, chosen = found.rungs[0], found.chosen
    rest = search.models.ceiling(chosen)
    verdict = judge(ended, weighed, doubts(search, found, rest))
    law = None if verdict.doubts else _law(search, found, rest, verdict.kind)
    notes = [*ready.said, *oddities(search, chosen, gate, rig=ready.rig)]
    notes += beyond(problems, ready.own, chosen.fit.changes)
    regimes = atlas(search.models.train, bare.fit.residual)
    written = document(ready.rig, search, found, verdict, rest, regimes, notes, ready.excluded)
    ranked = [c["name"] for c in written["candidates"]]
    written["switches"] = plain(switches(search, found, ranked))
    written["composed"] = plain(law.document) if law else None
    stands = chosen if verdict.kind == "named" else bare
    written["model"] = plain(standing(search, stands, ready.body))
    curves = None
    if ready.rig.predict != "effort":
        motion, curves = predicted(search, found)
        written["motion"] = plain(motion)
    return Diagnosis(
        checked(written),
        overlay(search, bare.fit, chosen.fit),
        parameters(search, bare.fit),
        gate.sentence,
        laws(problems[1], chosen.effects, chosen.fit.changes, problems[1].sizes.axis_unit),
        curves,
        law,
        heldout(search, stands),
    )


def _law(search: RigSearch, found: Found, rest: Ceiling, kind: str) -> Composed | None:
    """The law of what no name explains: of all that is left where there is none."""
    if kind == "unknown":
        return composed(search, found, found.rungs[0])
    if kind in ("named", "undecided") and structured(search.models, found.chosen, rest):
        return composed(search, found, found.chosen)
    return None


def _stroke(recordings: list[Recording]) -> float:
    return float(np.ptp(np.concatenate([p.q[p.use] for r in recordings for p in r.pieces])))
