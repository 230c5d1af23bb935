"""Machines whose errors are known, in place of an arm's or a rig's: what a search knows of one."""

from itertools import combinations
from types import SimpleNamespace

import numpy as np

from spirob.diagnosis.certainty import Ended
from spirob.diagnosis.criteria import Criteria
from spirob.diagnosis.model import Found, Left, Model, Offer, Predictor
from spirob.diagnosis.search import Search
from spirob.identify.fit import Estimate, Fit
from spirob.identify.problem import Effort

SAMPLES, BLOCK = 800, 20
LEAST = 0.01  # of an effort of size 1
SHARP = 0.05  # half an interval of a number of size 1
TRIALS = SimpleNamespace(
    effort=Effort("motor current", "A"),
    measured=lambda: np.ones(SAMPLES),
    rows=np.ones(SAMPLES, bool),
)


def fit_of(effects, residual, half=SHARP):
    """A fit that ended at amplitudes of 1, known to `half`."""
    numbers = {f"{e.name()}.{n}": 1.0 + zero for e in effects for n, zero in e.neutral.items()}
    told = {n: Estimate(v, v - half, v + half, "1", False) for n, v in numbers.items()}
    return Fit(numbers, told, residual, np.zeros((len(residual), 0)), float(residual @ residual), 1)


def model(effects, decided, heldout=None, residual=None, half=SHARP):
    """A set that leaves these RMS errors everywhere alike; `residual` (N,) if not the first."""
    left = np.full(SAMPLES, float(decided))
    residual = left if residual is None else residual
    found = fit_of(effects, residual, half)
    errors = np.full(SAMPLES // BLOCK, float(decided) ** 2)
    missed = left if heldout is None else np.full(SAMPLES, float(heldout))
    return Model(tuple(effects), found, left, errors, missed)


class Known(Predictor):
    """Answers with these models alone.

    share    of the squared error of any of them that is more than a complete machine's
    missing  whether the fitted numbers alone leave too much for a machine that misses nothing
    """

    promised = 0.5

    def __init__(self, *models, share=0.0, missing=True, said="", least=LEAST):
        self.train = self.heldout = TRIALS
        self.progress = lambda text: None
        self.names, self.size, self.tried = ["arm.a"], 1.0, {m.names: m for m in models}
        self.share, self.missing, self.said, self._least = share, missing, said, least

    @property
    def least(self):
        return self._least

    def fitted(self, effects, start):
        return self.tried[frozenset(e.name() for e in effects)]

    def grown(self, current, sets, counts, near=None):
        return []

    def offers(self, model, effects):
        return []

    def pairs(self, model, offers):
        return []

    def related(self, effect, others):
        return False

    def plain(self, model):
        return True

    def complete(self, model):
        return False

    def finished(self, model):
        return self.tried[model.names]

    def left(self, model):
        return Left(self.share, self.said, ("It is not known.", "Nothing says what it is."))

    def lacks(self, bare):
        return self.missing

    def nothing(self, bare):
        return "Nothing is left."


def ended(*models, rivals=None, equivalents=None, vetoed=(), criteria=None, **told):
    """A search over `Known` that ended with the last of these models, an effect after another."""
    known, chosen = Known(*models, **told), models[-1]
    names = [e.name() for e in chosen.effects]
    rungs = [known.tried[frozenset(names[:k])] for k in range(len(names) + 1)]
    found = Found(
        rungs,
        [],
        {n: list((rivals or {}).get(n, [])) for n in names},
        {n: list((equivalents or {}).get(n, [])) for n in names},
        list(vetoed),
    )
    return Ended(Search(known, [], criteria or Criteria()), found, known.left(chosen))


class Linear(Known):
    """A machine whose residual is a sum of columns: least squares fits any set of them exactly.

    missing   what the fitted numbers alone leave without noise, (2N,): N fitted, N held out
    columns   what an effect can make, (2N,) by effect
    absorbed  names of effects that the fitted numbers make themselves
    only_one  names of effects of which a machine has one alone;  odd  those that say nothing plain
    enough    mean square of a machine from which nothing is missing
    astray    beside it the numbers alone leave this, until a set that counts shows them the way
    """

    def __init__(self, missing, columns, noise=0.002, **told):
        super().__init__()
        none = {"absorbed": (), "only_one": (), "odd": (), "enough": 0.0, "astray": None}
        self.asked = none | told
        rng = np.random.default_rng(5)
        self.wanted = missing + noise * rng.standard_normal(2 * SAMPLES)
        self.columns = columns
        self.rounds, self.screened = [], []

    def _made(self, effects, beside=None):
        wanted, astray = self.wanted, self.asked["astray"]
        if astray is not None and not (effects if beside is None else beside):
            wanted = wanted + astray
        design = np.column_stack([self.columns[e] for e in effects] or [np.zeros(2 * SAMPLES)])
        amounts = np.linalg.lstsq(design[:SAMPLES], wanted[:SAMPLES], rcond=None)[0]
        left = wanted - design @ amounts
        own, held = left[:SAMPLES], left[SAMPLES:]
        errors = (own.reshape(-1, BLOCK) ** 2).mean(axis=1)
        return Model(tuple(effects), fit_of(effects, own), own, errors, held)

    def fitted(self, effects, start):
        key = frozenset(e.name() for e in effects)
        if key not in self.tried:
            self.tried[key] = self._made(effects)
        return self.tried[key]

    def grown(self, current, sets, counts, near=None):
        self.rounds.append([(*current.effects, *(o.effect for o in added)) for added in sets])
        found = [self.fitted(effects, {}) for effects in self.rounds[-1]]
        if self.asked["astray"] is not None and any(counts(current, m) for m in found):
            self.asked["astray"] = None
            self.tried[frozenset()] = self._made(())
        return found

    def offers(self, model, effects):
        self.screened.append((model.names, [e.name() for e in effects]))
        beside = {e: self._made((*model.effects, e), model.effects).mean_square for e in effects}
        new = {e: 0.0 if e.name() in self.asked["absorbed"] else 1.0 for e in effects}
        ranked = sorted(effects, key=lambda e: beside[e])
        return [Offer(e, {}, beside[e], new[e]) for e in ranked]

    def pairs(self, model, offers):
        made = [
            (self._made((*model.effects, a.effect, b.effect)).mean_square, a, b)
            for a, b in combinations(offers, 2)
        ]
        return sorted(made, key=lambda pair: pair[0])

    def related(self, effect, others):
        only = self.asked["only_one"]
        return effect.name() in only and any(o.name() in only for o in others)

    def plain(self, model):
        return model.names.isdisjoint(self.asked["odd"])

    def complete(self, model):
        return model.mean_square < self.asked["enough"]
