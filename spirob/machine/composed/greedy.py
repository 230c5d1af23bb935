"""A law composed term by term, each of which is needed on blocks that no fit saw."""

from collections.abc import Callable, Sequence
from itertools import groupby

import numpy as np
import scipy

from spirob.machine.composed.draft import Draft, Drafts, Offers
from spirob.machine.composed.grammar import bristled, losses, terms
from spirob.machine.composed.ground import Ground
from spirob.machine.composed.terms import Term
from spirob.machine.composed.track import Ranges

MOST = 4  # terms
FINALISTS = 6  # of a round, whose numbers are refined
REFINED = 25  # steps for each number of a shape
MOVES = 4  # of the fitted numbers, once a term is there
SETTLED = 1e-3  # relative, of the mean square: a refinement ends


def compose(ground: Ground) -> list[tuple[Drafts, Draft]]:
    """The terms that a law of what a model leaves is made of; none where none is needed.

    A law acts beside the drive or on it: both are composed, and come in the order in which terms
    are chosen.
    """
    laws = [law for grammar in (terms, losses) if (law := _composed(ground, grammar)) is not None]
    if not laws:
        return []
    plain = _simplest(laws[0][0], [draft for _, draft in laws])
    return sorted(laws, key=lambda law: law[1] is not plain)


Grammar = Callable[[Ranges, np.ndarray, dict[str, np.ndarray], bool], list[Term]]


def _composed(ground: Ground, grammar: Grammar) -> tuple[Drafts, Draft] | None:
    """The law of one grammar.

    A term is added where it passes the questions of `worth` and the held-out trials agree; of those
    that do about as well the one of fewest numbers.  Whatever is no longer needed beside the others
    goes again.  One term at most remembers.
    """
    drafts = Drafts(ground)
    current = drafts.made(())
    track = ground.train.track
    signals = {n: ground.train.thinned(v) for n, v in track.signals.items()}
    while len(current.terms) < MOST:
        found = grammar(drafts.ranges, current.left, signals, track.placed)
        if not found:
            break
        ground.progress(f"a law of {len(current.terms) + 1} terms")
        grown = _best(drafts, drafts.offers(found), current)
        if grown is None:
            break
        kept = _needed(drafts, _bristled(drafts, _settled(drafts, grown)))
        if kept.terms == current.terms or kept.mean_square >= current.mean_square:
            break
        drafts, current = _moved(drafts, kept)
    if not current.terms:
        return None
    return _moved(drafts, _exchanged(drafts, current, signals, grammar))


def _moved(drafts: Drafts, draft: Draft) -> tuple[Drafts, Draft]:
    """The draft at the numbers that it asks for, as long as that lowers its error.

    Without the law the numbers were fitted to something else: most of all the delay, of which the
    residual is no linear function.
    """
    for _ in range(MOVES):
        other = drafts.moved(draft)
        after = other.made(draft.terms)
        if after.mean_square >= draft.mean_square:
            break
        settled = after.mean_square > (1.0 - SETTLED) * draft.mean_square
        drafts, draft = other, after
        if settled:
            break
    return drafts, draft


def _best(drafts: Drafts, offers: Offers, current: Draft) -> Draft | None:
    """The draft with one more term, None where none matters.

    Where the held-out trials deny all of a round that matter, the kinds that come next are asked:
    what reaches beyond the motion of the fit says less there.
    """
    worth = drafts.ground.worth
    remembers = any(term.memory for term in current.terms)
    errors = offers.errors(current.terms)
    errors[[remembers and term.memory is not None for term in offers.terms]] = np.inf
    kinds = [k for k in _ranked(offers.terms, errors) if np.isfinite(errors[k])]
    passed: list[Draft] = []
    while kinds and not passed:
        made = []
        for k in kinds[:FINALISTS]:
            term = _refined(drafts, current.terms, offers.terms[k])
            made.append(drafts.made((*current.terms, term)))
        kinds, counting = kinds[FINALISTS:], [d for d in made if worth.matters(current, d)]
        passed = [d for d in counting if not worth.denied(current, d) and drafts.balanced(d)]
        if not counting:
            break
    return _simplest(drafts, passed) if passed else None


def _ranked(found: Sequence[Term], errors: np.ndarray) -> list[int]:
    """The best term of each kind, the best kinds first."""
    order = sorted(range(len(found)), key=lambda k: (found[k].kinds, errors[k]))
    firsts = [next(group) for _, group in groupby(order, key=lambda k: found[k].kinds)]
    return sorted(firsts, key=lambda k: errors[k])


def _simplest(drafts: Drafts, passed: Sequence[Draft]) -> Draft:
    """The poorest draft to which no other is clearly preferable."""
    best = min(passed, key=lambda d: d.mean_square)
    equal = [d for d in passed if d is best or not drafts.ground.worth.clearly(d, best)]
    return min(equal, key=lambda d: (d.richness, d.mean_square))


def _settled(drafts: Drafts, draft: Draft) -> Draft:
    """The numbers of each earlier term once more, now that the last one is there."""
    found = list(draft.terms)
    for k, term in enumerate(found[:-1]):
        found[k] = _refined(drafts, [t for t in found if t is not term], term)
    better = drafts.made(found)
    return better if better.mean_square < draft.mean_square else draft


def _bristled(drafts: Drafts, draft: Draft) -> Draft:
    """With a bristle for the direction of one of its terms, where that is clearly better."""
    if any(term.memory for term in draft.terms):
        return draft
    made = []
    for k, term in enumerate(draft.terms):
        beside = [t for t in draft.terms if t is not term]
        tried = bristled(term, drafts.ranges)
        if tried:
            first = min(tried, key=lambda t: drafts.error(beside, t))
            turned = _refined(drafts, beside, first)
            made.append(drafts.made([*draft.terms[:k], turned, *draft.terms[k + 1 :]]))
    worth = drafts.ground.worth
    better = [d for d in made if worth.clearly(draft, d) and not worth.denied(draft, d)]
    return min(better, key=lambda d: d.mean_square) if better else draft


def _exchanged(
    drafts: Drafts, draft: Draft, signals: dict[str, np.ndarray], grammar: Grammar
) -> Draft:
    """With another term for each where that is clearly better, or as good and simpler.

    The first term was chosen while the others were missing, and the numbers were fitted to
    something else.
    """
    for k in range(len(draft.terms)):
        beside = drafts.made([t for j, t in enumerate(draft.terms) if j != k])
        found = grammar(drafts.ranges, beside.left, signals, drafts.ground.train.track.placed)
        other = _best(drafts, drafts.offers(found), beside)
        if other is not None and other.heldout_square <= draft.heldout_square:
            draft = _simplest(drafts, [draft, other])
    return draft


def _needed(drafts: Drafts, draft: Draft) -> Draft:
    """Without terms that no longer matter beside the others."""
    worth = drafts.ground.worth
    while len(draft.terms) > 1:
        lesser = [drafts.made([t for t in draft.terms if t is not term]) for term in draft.terms]
        weak = [d for d in lesser if not worth.matters(d, draft) or worth.denied(d, draft)]
        if not weak:
            return draft
        draft = min(weak, key=lambda d: d.mean_square)
    return draft


def _refined(drafts: Drafts, beside: Sequence[Term], term: Term) -> Term:
    """The term with the numbers of its shapes where the folds left out like them best."""
    keys, box = list(term.numbers), term.box
    if not keys:
        return term
    logs = np.array([box[key][0] > 0 for key in keys])
    ends = np.array([box[key] for key in keys]).T

    def seen(values: np.ndarray) -> np.ndarray:
        return np.where(logs, np.log(np.where(logs, values, 1.0)), values)

    low, high = seen(ends[0]), seen(ends[1])

    def at(share: np.ndarray) -> Term:
        u = low + np.clip(share, 0.0, 1.0) * (high - low)
        values = np.where(logs, np.exp(np.where(logs, u, 0.0)), u)
        return term.at(dict(zip(keys, map(float, values), strict=True)))

    start = (seen(np.array([term.numbers[key] for key in keys])) - low) / (high - low)
    first = drafts.error(beside, term)
    if not first:
        return term
    # shares of a wide box: a walk from the grid's place begins with small steps
    simplex = np.vstack([start, *(start + 0.04 * unit for unit in np.eye(len(start)))])
    found = scipy.optimize.minimize(
        lambda share: drafts.error(beside, at(share)) / first,
        start,
        method="Nelder-Mead",
        options={
            "initial_simplex": simplex,
            "maxfev": REFINED * len(keys),
            "xatol": 1e-4,
            "fatol": SETTLED,
        },
    )
    return at(found.x) if found.fun < 1.0 else term
