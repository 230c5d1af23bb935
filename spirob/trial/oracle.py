"""The oracle: the error that remains once the right effect is known.

The library's counterpart of what is hidden is added and everything refitted.  No diagnosis can be
expected to do better, and where the oracle gains nothing, nothing can be named.  Its own fit must
not be what fails, so it begins at the base and from afar too, as that of a leader of the search.
"""

from collections.abc import Mapping, Sequence

from spirob.diagnosis.afar import to_the_end
from spirob.diagnosis.confirm import confirm
from spirob.diagnosis.rungs import Rung, Search, Settings
from spirob.diagnosis.screen import screen
from spirob.effects import Effect
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
    # what the data did not tell without the effect they may tell with it
    names = [*base.fit.estimates, *search.vague]
    found = [r.scores for r in search.rungs if set(r.effects) == wanted]
    found += [c.scores for tried in search.rounds[:1] for c in tried if set(c.effects) == wanted]
    errors = [base.scores["heldout"].rmse, *(s["heldout"].rmse for s in found)]
    if effects and (not found or min(errors) > ENOUGH * errors[0]):
        errors.append(_fitted(problems, base, names, effects, settings))
    return min(errors)


def _fitted(
    problems: Mapping[str, Problem],
    base: Rung,
    names: Sequence[str],
    effects: Sequence[type[Effect]],
    settings: Settings,
) -> float:
    train = near(problems["train"], base.fit.changes)
    started = screen(train, base.fit, names, effects, settings.scale)
    found = confirm(started, base, {**problems, "train": train}, settings, _silent)
    return to_the_end(found, problems, settings, _silent).scores["heldout"].rmse


def _silent(text: str) -> None:
    pass
