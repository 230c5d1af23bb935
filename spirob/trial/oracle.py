"""The oracle: the error that remains once the right effect is known.

The library's counterpart of what is hidden is added and everything refitted.  No diagnosis can be
expected to do better, and where the oracle gains nothing, nothing can be named.
"""

from collections.abc import Mapping, Sequence

from spirob.diagnose.confirm import confirm, shaped
from spirob.diagnose.rungs import Search, Settings
from spirob.diagnose.screen import screen
from spirob.effects import Effect
from spirob.identify.problem import Problem


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
    known = [r.scores for r in search.rungs if set(r.effects) == wanted]
    known += [c.scores for tried in search.rounds[:1] for c in tried if set(c.effects) == wanted]
    if effects and not known:
        train = problems["train"]
        started = screen(train, base.fit, list(base.fit.estimates), effects, settings.scale)
        found = confirm(started, base, problems, settings, _silent)
        known = [shaped(found, problems, settings, _silent).scores]
    return min(scores["heldout"].rmse for scores in [base.scores, *known])


def _silent(text: str) -> None:
    pass
