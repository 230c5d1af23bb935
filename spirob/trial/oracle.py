"""The oracle: the error that remains once the right effect is known.

The library's counterpart of what is hidden is added and everything refitted.  No diagnosis can be
expected to do better, and where the oracle gains nothing, nothing can be named.
"""

from collections.abc import Mapping, Sequence

from spirob.diagnose.rungs import Rung, Settings, parameters_of
from spirob.diagnose.screen import screen
from spirob.effects import Effect
from spirob.identify.fit import STEPS, fit
from spirob.identify.problem import Problem
from spirob.score import score


def oracle(
    problems: Mapping[str, Problem],
    base: Rung,
    effects: Sequence[type[Effect]],
    settings: Settings,
) -> float:
    """RMSE on held-out trials with `effects` added, at most the base's; in the effort's unit."""
    before = base.scores["heldout"].rmse
    if not effects:
        return before
    train, held = problems["train"], problems["heldout"]
    started = screen(train, base.fit, list(base.fit.estimates), effects, settings.scale)
    names, begin = list(base.fit.estimates), dict(base.fit.changes)
    for one in started:
        begin = {**one.changes, **begin} if len(started) > 1 else dict(one.changes)
        own = [n for n in parameters_of(one.effect) if n in train.table.about]
        names += [n for n in own if n not in names]
        begin |= {n: one.changes[n] for n in own if n in one.changes}
    found = fit(train, names, begin, settings.scale, settings.patience, steps=STEPS, exact=False)
    measured = held.measured()[held.rows]
    after = score(measured, measured + held(found.changes)[held.rows]).rmse
    return min(before, after)
