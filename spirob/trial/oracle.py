"""The oracle: the error that remains once the right effect is known.

The library's counterpart of what is hidden is added and everything refitted.  No diagnosis can be
expected to do better, and where the oracle gains nothing, nothing can be named.  Its own fit must
not be what fails, so it begins at the base, and where that does not help much at the data sheet
too: an effect that moved the base's numbers far may not be seen from there.
"""

from collections.abc import Mapping, Sequence

from spirob.diagnose.confirm import confirm, shaped
from spirob.diagnose.rungs import Rung, Search, Settings, scores_of
from spirob.diagnose.screen import amplitudes, screen
from spirob.effects import Effect
from spirob.identify.fit import fit
from spirob.identify.near import near
from spirob.identify.problem import Problem

ENOUGH = 0.6  # of the base's error: with less the fit did not fail


def oracle(
    problems: Mapping[str, Problem],
    search: Search,
    effects: Sequence[type[Effect]],
    settings: Settings,
) -> float:
    """RMSE on held-out trials with `effects` added, at most the base's; in the effort's unit.

    What the search has already fitted is not fitted again.
    """
    base, wanted = search.rungs[0], set(effects)
    found = [r.scores for r in search.rungs if set(r.effects) == wanted]
    found += [c.scores for tried in search.rounds[:1] for c in tried if set(c.effects) == wanted]
    errors = [base.scores["heldout"].rmse, *(s["heldout"].rmse for s in found)]
    if effects and not found:
        errors.append(_from_the_base(problems, base, effects, settings))
    if effects and min(errors) > ENOUGH * errors[0]:
        errors.append(_from_the_data_sheet(problems, base, effects, settings))
    return min(errors)


def _from_the_base(
    problems: Mapping[str, Problem],
    base: Rung,
    effects: Sequence[type[Effect]],
    settings: Settings,
) -> float:
    train = near(problems["train"], base.fit.changes)
    close = {**problems, "train": train}
    started = screen(train, base.fit, list(base.fit.estimates), effects, settings.scale)
    found = confirm(started, base, close, settings, _silent)
    return shaped(found, close, settings, _silent).scores["heldout"].rmse


def _from_the_data_sheet(
    problems: Mapping[str, Problem],
    base: Rung,
    effects: Sequence[type[Effect]],
    settings: Settings,
) -> float:
    train = problems["train"]
    names = [*base.fit.estimates, *(n for e in effects for n in amplitudes(e, train))]
    cheap = near(train, {})
    found = fit(cheap, names, {}, settings.scale, settings.patience, exact=False)
    return scores_of(found, problems)[0]["heldout"].rmse


def _silent(text: str) -> None:
    pass
