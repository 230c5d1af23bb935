"""The diagnosis of a plain rig from its recordings: check, fit, search, judge."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from pathlib import Path

from spirob.diagnosis.conclusion import likely
from spirob.diagnosis.criteria import Criteria
from spirob.diagnosis.flexible import one_thread
from spirob.diagnosis.model import Found, Model, alike
from spirob.diagnosis.search import Search
from spirob.diagnosis.verdict import TWICE
from spirob.effects import Effect
from spirob.errors import DataError
from spirob.machine.description.rig import Bounded, RigFile
from spirob.machine.document import SHORTER, written
from spirob.machine.inverse.problem import Work
from spirob.machine.recordings.recording import Recording
from spirob.machine.recordings.selection import ASIDE, ends_aside
from spirob.machine.result import Diagnosis
from spirob.machine.search.delays import AS_LOGGED, DELAY, as_usual, place, turning, widened
from spirob.machine.search.differing import counted_alike, differing
from spirob.machine.search.foretold import foretells, passes, swallows
from spirob.machine.search.judging import Judged, Searched, judged_of
from spirob.machine.search.models import RigSearch
from spirob.machine.search.odd_logs import another_unit
from spirob.machine.search.plausibility import (
    AT_LOAD,
    fits_at_load,
    may_sit_at_load,
    only_of_logs,
    untaught,
)
from spirob.machine.search.preparation import Ready, moving, ready_of, search_of
from spirob.machine.search.wrong_numbers import beyond_bounds, in_scale, released

NOT_ELSEWHERE = f"Not looked for about another delay: {SHORTER}"
UNTRIED = f"The search took so long that it was not repeated: {SHORTER}"


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

    def told(train: list[Recording], test: list[Recording], said: Sequence[str] = ()) -> Ready:
        ready = ready_of(rig, folder, train, test, own, without)
        said = list(dict.fromkeys([*ready.said, *said]))  # both parts of a log have its repairs
        decided = settings or rig.criteria
        return replace(ready, settings=decided, progress=progress, said=said, work=work)

    work = Work()
    with one_thread():
        judged = _about_its_law(_without_numbers_of_logs(judged_of(_found(told(train, test)))))
        said = untaught(judged.search, judged.chosen, judged.verdict)
        if said and judged.done.is_long:
            judged = judged.noted(f"{said} {UNTRIED}")
        elif said:
            progress("once more, with the end of every log held out")
            again = _taught_by_all(told, judged.done.ready, [*train, *test], said)
            judged = again if again and _says_more(again, judged) else judged.noted(said)
        odd = only_of_logs(judged.search, judged.found, judged.verdict)
        return replace(written(judged), strange=odd.names if odd and not odd.mended else ())


def _says_more(again: Judged, judged: Judged) -> bool:
    """Whether a verdict by more data has names, all of the other's, or a law where it has none."""
    if again.verdict.kind == "unknown":
        return judged.verdict.kind == "unknown" and again.law is not None and judged.law is None
    told = {*likely(again.verdict.weighed), *again.verdict.equivalents, *again.verdict.rivals}
    return told.issuperset(likely(judged.verdict.weighed))


def _taught_by_all(
    told: Callable[..., Ready], ready: Ready, logs: list[Recording], said: str
) -> Judged | None:
    """The verdict with the end of every log held out; None where its logs are too short for it."""
    moved, lost = moving(ready.rig, logs, ready.rest_speed)
    try:
        kept, held, more = ends_aside(moved)
        return judged_of(_found(told(kept, held, [f"{said} {ASIDE}", *more, *lost])))
    except DataError:
        return None


def _found(ready: Ready) -> Searched:
    """The whole search: about its delay, within its bounds, with numbers of logs, by the sensor."""
    placed = counted_alike(_placed(in_scale(ready)))
    search, gate = search_of(placed)
    if another_unit((search.models.train, search.models.heldout)):  # no law means anything
        return Searched(placed, search, gate, Found([search.models.fitted((), {})]))
    done = _set_free(_once_more(Searched(placed, search, gate, search.run())))
    return _foretelling(_set_free(_with_sensor_at_load(_with_numbers_of_logs(done))))


def base_model(
    rig: RigFile, folder: Path, train: list[Recording], test: list[Recording]
) -> tuple[Search, Model]:
    """The fitted numbers alone, without a search: what a machine leaves that misses no effect."""
    with one_thread():
        ready = _placed(ready_of(rig, folder, train, test))
        search, _ = search_of(ready)
        return search, search.models.fitted((), {})


def _with_numbers_of_logs(done: Searched) -> Searched:
    """With a payload, force or zero of each log, where the logs differ by it; by what fits best.

    Asked beside what a search chose, and in its place: that may have taken what the logs differ by.
    """
    about, bare = (done.ready, done.search), done.search.models.fitted((), {})
    found = differing(*about, done.chosen) or differing(*about, bare, done.chosen)
    return _better(done, _searched(found[0]), found[1]) if found else done


def _with_sensor_at_load(done: Searched) -> Searched:
    """With the position sensor at the load, where nothing is said of it and the logs fit that."""
    if not may_sit_at_load(done.ready.rig, done.search, done.chosen):
        return done
    told = done.ready.at_load()
    search, gate = search_of(told)
    if not fits_at_load(search, done.chosen):
        return done
    found = search.run()
    if not done.search.worth.halves(done.chosen, found.chosen):
        return done
    return Searched(replace(told, said=[*told.said, AT_LOAD]), search, gate, found)


def _foretelling(done: Searched) -> Searched:
    """Without laws that swallow the effort, where it is foretold better so."""
    search = done.search
    if not swallows(search.models, done.chosen):
        return done
    done.ready.progress("once more, without laws between the effort and its torque")
    others = [e for e in search.candidates if not passes(e)]
    other = Search(search.models, others, search.criteria, done.ready.progress)
    found = other.run()
    if foretells(search.models, done.chosen, found.chosen):
        return done
    search.models.forget(passes)
    return replace(done, search=other, found=found)


def _set_free(done: Searched) -> Searched:
    """Searched with wider bounds of the numbers that ended at those that the description gives.

    Not where that ends with twice the squared error of the held-out logs.
    """
    given, now = done.ready.given.fit, done.ready.rig.fit
    at_bound = beyond_bounds(done.search, done.chosen)
    free = [name for name in at_bound if name in given and now[name] == given[name]]
    if not free:
        return done
    done.ready.progress(f"once more, with {', '.join(free)} set free of its bounds")
    wider = {name: released(now[name]) for name in free}
    ready = _placed(done.ready.told(fit={**now, **wider}))
    search, gate = search_of(ready)
    again = search.models.fitted(done.chosen.effects, done.chosen.fit.changes)
    more = done.search.worth.matters(done.chosen, again)
    found = search.run() if more else search.settled(again)
    worse = done.search.worth.refuted(found.chosen, done.chosen)
    return done if worse else Searched(ready, search, gate, found)


def _searched(ready: Ready) -> Searched:
    search, gate = search_of(ready)
    return Searched(ready, search, gate, search.run())


def _placed(ready: Ready) -> Ready:
    """With a delay between effort and motion to fit, where the description tells nothing of it."""
    if not ready.untold:
        return ready
    fit = {name: bounds for name, bounds in ready.rig.fit.items() if name != "delay"}
    search, _ = search_of(ready.told(known={**ready.rig.known, "delay": 0.0}, fit=fit))
    ready.progress("effort and motion are laid over one another")
    return _about(ready, _place(search, search.models.fitted((), {})))


def _about(ready: Ready, delay: Bounded) -> Ready:
    return ready.told(fit={**ready.rig.fit, "delay": delay})


def _place(search: RigSearch, model: Model) -> Bounded:
    return place(search.models.train, model, search.models.folds, search.absent(model))


def _once_more(done: Searched) -> Searched:
    """The search about another delay, where something that counts is left and that explains more.

    The effects that were found say more of the delay than any one of the library did: where they
    place it elsewhere and explain more there, or it ended at a bound, it is searched there.  The
    usual one is tried where it was none of those looked at, and the fitted numbers end elsewhere
    about it: a place found beside coarse shapes of laws may be another law's.
    """
    little = done.chosen.mean_square < (TWICE * done.search.worth.least) ** 2
    if little or not done.ready.untold:
        return done
    fitted, none = done.ready.rig.fit["delay"], as_usual(max(r.period for r in done.ready.train))
    anew, others = _place(done.search, done.chosen), []
    if not _as_wide(anew, fitted) and (
        _at_bound(done) or _fits_better(done, _about(done.ready, anew), anew)
    ):
        others.append(anew)
    usual = none.low < fitted.low or fitted.high < none.high
    known = any(_as_wide(none, other) for other in others)
    if not known and usual and not _begins_alike(done, none):
        others.append(none)
    for delay in others:
        if done.is_long:
            return done.noted(NOT_ELSEWHERE)
        done.ready.progress(
            f"once more, with the effort about {1e3 * delay.nominal:.2g} ms after the motion"
        )
        other = _searched(_about(done.ready, delay))
        done = other if done.search.worth.matters(done.chosen, other.chosen) else done
    return _within_wider(done)


def _within_wider(done: Searched) -> Searched:
    """The search within twice as wide bounds of the delay, while it ends at one and less is left.

    It goes no farther than the motion needs to turn into another.
    """
    if not _at_bound(done):
        return done
    wider = widened(done.ready.rig.fit["delay"])
    far = max(wider.high, -wider.low) > turning(done.ready.train)
    if far or not _fits_better(done, _about(done.ready, wider), wider):
        return done
    if done.is_long:
        return done.noted(NOT_ELSEWHERE)
    done.ready.progress("once more, with twice as wide bounds of the delay")
    other = _searched(_about(done.ready, wider))
    return _within_wider(other) if done.search.worth.matters(done.chosen, other.chosen) else done


def _at_bound(done: Searched) -> bool:
    return done.chosen.fit.estimates[DELAY].at_bound


def _without_numbers_of_logs(judged: Judged) -> Judged:
    """The verdict without numbers of single logs, where much is left that is explained so.

    They were found out beside laws of the library.  A law that it lacks differs from log to log, as
    the motion does, and a payload or a force of each log takes a part of that.
    """
    plain, worth = judged.done.plain, judged.search.worth
    if plain is None or judged.verdict.kind not in ("unknown", "nothing_missing"):
        return judged
    if judged.explained.mean_square < (TWICE * worth.least) ** 2:
        return judged
    again = judged_of(plain)
    return again if _outdoes(again, judged) else judged


def _about_its_law(judged: Judged) -> Judged:
    """The verdict about another delay, where nothing is named and all of it explains more there.

    The delay was placed beside laws of the library.  What a law composed since says of it, the
    usual one and none at all are looked at, too.
    """
    done = judged.done
    if judged.verdict.kind != "unknown" or judged.verdict.doubts or not done.ready.untold:
        return judged
    others = _other_delays(judged)
    for delay in others:
        if done.is_long:
            return judged.noted(NOT_ELSEWHERE)
        again = judged_of(_searched(_about(done.ready, delay)))
        judged = again if _outdoes(again, judged) else judged
    return judged


def _outdoes(again: Judged, judged: Judged) -> bool:
    """Whether less than half is left; of the held-out logs alone, where the others do not tell."""
    worth, before, after = judged.search.worth, judged.explained, again.explained
    alike = not worth.matters(after, before) and worth.refuted(before, after)
    return not again.verdict.doubts and (alike or worth.halves(before, after))


def _other_delays(judged: Judged) -> list[Bounded]:
    """Where the delay may be, but not where it was fitted: by the law, as usual, and none."""
    done = judged.done
    fitted, usual = done.ready.rig.fit["delay"], as_usual(max(r.period for r in done.ready.train))
    others = [usual] if usual.low > fitted.high or usual.high < fitted.low else []
    if judged.law is not None:
        anew = _place_beside(done.search, judged.law.model)
        known = any(_as_wide(anew, other) for other in (fitted, *others))
        others = others if known else [*others, anew]
    found = judged.explained.fit.changes[DELAY]
    return others if abs(found) <= AS_LOGGED.high else [*others, AS_LOGGED]


def _as_wide(one: Bounded, other: Bounded) -> bool:
    """Whether two delays have the same bounds: what is searched in them hardly differs."""
    return (one.low, one.high) == (other.low, other.high)


def _place_beside(search: RigSearch, model: Model) -> Bounded:
    """Where a composed law, the last effect of a model, places the delay."""
    problem = search.models.train.beside(model.effects[-1])
    return place(problem, model, search.models.folds, ())


def _fits_better(done: Searched, told: Ready, delay: Bounded | None = None) -> bool:
    """Whether the chosen effects explain more with something else told, such as another delay."""
    search, _ = search_of(told)
    begin = done.chosen.fit.changes | ({DELAY: delay.nominal} if delay else {})
    return done.search.worth.matters(done.chosen, search.models.fitted(done.chosen.effects, begin))


def _begins_alike(done: Searched, delay: Bounded) -> bool:
    """Whether a search about another delay begins as one about the fitted one, and may end so."""
    search, _ = search_of(_about(done.ready, delay))
    bare, found = search.models.fitted((), {}), done.chosen.fit.changes[DELAY]
    inside = delay.low < found < delay.high
    return inside and alike(bare, done.found.rungs[0], done.search.worth.least)


def _better(done: Searched, wider: Searched, said: str) -> Searched:
    """What was searched with numbers of single logs, where that explains more by what counts."""
    if not done.search.worth.matters(done.chosen, wider.chosen):
        return done
    return replace(wider.noted(said), plain=done)
