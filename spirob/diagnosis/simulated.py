"""Sets of effects on an arm, each fitted in full simulation: the `Predictor` of the search.

Fits use the training trials, decisions the validation trials; the held-out trials veto.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from copy import copy
from itertools import combinations
from typing import Any

import numpy as np

from spirob.diagnosis.criteria import Settings, block_errors, complete, foreseen
from spirob.diagnosis.fitting import (
    Begun,
    again_from,
    briefly,
    confirmed,
    lastly,
    parameters_of,
    slowest,
    to_the_end,
    without_slowest,
)
from spirob.diagnosis.model import Counts, Left, Model, Offer, Predictor, Sets, another_dry, label
from spirob.diagnosis.screen import Screened, amplitudes, screen
from spirob.effects import Effect
from spirob.identify.builds import RESOLUTION, Floor
from spirob.identify.fit import INDEPENDENT, Fit
from spirob.identify.intervals import Score, score
from spirob.identify.problem import Problem, effort_rms, rms
from spirob.identify.residual import near

ROLES = ("train", "validate", "heldout")
PAIRED = 3  # candidates of which pairs are tried
LEADERS = 2  # candidates fitted until they settle, with their shapes too
REACH = 4.0  # times the least mean square: who missed more is fitted no further
Measure = Callable[[Fit], Floor]


def modelled(
    effects: Sequence[type[Effect]], found: Fit, residuals: Mapping[str, Problem]
) -> Model:
    """A fit with its errors.

    How large an effect is, trials that no fit has seen say.  How surely, those and the fitted ones:
    two short trials may hold an effect in two half-seconds alone, which one of eight draws leaves
    out.  A mean is over samples of the effort, to which further signals only add.
    """
    train, validate, heldout = (residuals[role] for role in ROLES)
    left = validate(found.changes) / np.sqrt(np.mean(validate.rows))
    own = found.residual / np.sqrt(np.mean(train.rows))
    fitted = block_errors(own, train.edges, train.block)
    as_new = foreseen(fitted, len(found.estimates), len(own) // INDEPENDENT)
    errors = np.concatenate([block_errors(left, validate.edges, validate.block), as_new])
    return Model(tuple(effects), found, left, errors, heldout(found.changes)[heldout.rows])


def scores(model: Model, residuals: Mapping[str, Problem]) -> dict[str, Score]:
    """Scores of the effort, by role."""
    train, validate = residuals["train"], residuals["validate"]
    missed = {
        "train": model.fit.residual[train.rows],
        "validate": (model.left * np.sqrt(np.mean(validate.rows)))[validate.rows],
        "heldout": model.heldout,
    }
    found = {}
    for role, values in missed.items():
        measured = residuals[role].measured()[residuals[role].rows]
        found[role] = score(measured, measured + values)
    return found


class Simulated(Predictor):
    """Fits sets of effects to an arm's trials, and keeps every model.

    residuals  by role; one plant holds all candidates;  names  fitted with every set
    begun      the fit of these alone
    measure    the floor of a machine with such a fit; None: that of the settings stands
    """

    promised, certainty = 0.0, "arm"  # far from its optimum a simulation shows little of an effect

    def __init__(
        self,
        residuals: Mapping[str, Any],
        names: Sequence[str],
        settings: Settings,
        begun: Begun,
        measure: Measure | None = None,
    ):
        self.residuals, self.names, self.settings = dict(residuals), list(names), settings
        self.train, self.validate, self.heldout = (self.residuals[role] for role in ROLES)
        self.vague, self.measure = list(begun.vague), measure
        self.progress: Callable[[str], None] = lambda text: None
        self.size = effort_rms(self.validate)
        self.robust = settings.scale
        self.tried: dict[frozenset[str], Model] = {}
        self._seen: set[str] = set()
        self.added((), begun.fit)
        stated = Floor(settings.floor, "")
        self._alone = self._beside = measure(begun.fit) if measure else stated
        self._screened: dict[frozenset[str], dict[str, Screened]] = {}
        self._done: set[frozenset[str]] = {frozenset()}  # with intervals
        self._settled: dict[frozenset[str], Model] = {}

    @property
    def least(self) -> float:
        """Size of the least effect that counts, in the unit of the effort.

        Without an effect that is there the fitted numbers make up for it, and may stand where
        builds differ by far more than those of the machine itself: the lower floor counts.
        """
        return max(self.settings.floor, self._beside.share) * self.size

    def floor_of(self, model: Model) -> Floor:
        """What builds of a machine with this model differ by."""
        return self._beside if model.effects else self._alone

    def added(self, effects: Sequence[type[Effect]], found: Fit) -> Model:
        """Keep the model of a fit."""
        model = modelled(effects, found, self.residuals)
        self.tried[model.names] = model
        self._seen |= model.names
        share = np.sqrt(model.mean_square) / self.size
        self.progress(f"{label(model.effects)}: {share:.2%} of the effort left")
        return model

    def fitted(self, effects: tuple[type[Effect], ...], start: Mapping[str, float]) -> Model:
        """The model of a set, fitted briefly from `start`, less what that holds of others."""
        key = frozenset(e.name() for e in effects)
        if key not in self.tried:
            own = [n for e in effects for n in parameters_of(e) if n in self.train.table.about]
            others = self._seen - key - {n.split(".")[0] for n in self.names}
            begin = {n: v for n, v in start.items() if n.split(".")[0] not in others}
            train = near(self.train, begin)
            self.added(effects, briefly(train, [*self.names, *own], begin, self.settings))
        return self.tried[key]

    def offers(self, model: Model, effects: Sequence[type[Effect]]) -> list[Offer]:
        """The effects beside a model, by a screening in simulation.

        What does the same as a fitted number is none.
        """
        effects = [e for e in effects if not set(e.stands_for) & set(self.names)]
        known = self._screened.setdefault(model.names, {})
        if untried := [e for e in effects if e.name() not in known]:
            self._seen |= {e.name() for e in untried}
            train = near(self.train, model.fit.changes)
            beside = [n for e in model.effects for n in amplitudes(e, train)]
            names, scale = [*self.names, *beside], self.settings.scale
            found = screen(train, model.fit, names, untried, scale)
            known |= {s.effect.name(): s for s in found}
            best = ", ".join(f"{s.effect.name()} {s.gain:+.0%}" for s in found[:5])
            self.progress(f"screened beside {label(model.effects)}: {best}")
        ranked = sorted((known[e.name()] for e in effects), key=lambda s: -s.gain)
        square = model.mean_square
        return [Offer(s.effect, s.changes, (1.0 - s.gain) * square) for s in ranked]

    def pairs(self, model: Model, offers: Sequence[Offer]) -> list[tuple[float, Offer, Offer]]:
        """Pairs of the first, where nothing was added yet and much is left; promises add up."""
        if model.effects or self._within(model):
            return []
        square = model.mean_square
        first = [o for o in offers if o.error < square][:PAIRED]
        found = [
            (max(0.0, one.error + two.error - square), one, two)
            for one, two in combinations(first, 2)
        ]
        return sorted(found, key=lambda pair: pair[0])

    def grown(
        self, current: Model, sets: Sets, counts: Counts, near: Model | None = None
    ) -> list[Model]:
        """The model with each of these sets added; of those that count the leaders to the end."""
        keys = [current.names | {o.effect.name() for o in added} for added in sets]
        if fresh := self._confirmed(current, sets, keys):
            self._measured(current, fresh)
            passed = [self.tried[k] for k in keys if counts(current, self.tried[k])]
            current = self._again(current, passed)
            self._lead([m for m in passed if counts(current, m)])
        return [self.tried[key] for key in keys]

    def _confirmed(
        self,
        current: Model,
        sets: Sequence[tuple[Offer, ...]],
        keys: Sequence[frozenset[str]],
    ) -> list[Model]:
        """Those that were not fitted before, fitted briefly from where the screening left them.

        They stay near the model that they begin at; what leads is fitted on the trials themselves.
        """
        close, fresh = near(self.train, current.fit.changes), []
        self.offers(current, [o.effect for added in sets for o in added])
        known = self._screened[current.names]
        for added, key in zip(sets, keys, strict=True):
            if key not in self.tried:
                effects = (*current.effects, *(o.effect for o in added))
                chosen = [known[o.effect.name()] for o in added]
                fresh.append(self.added(effects, confirmed(close, chosen, self.settings)))
        return fresh

    def _measured(self, current: Model, fresh: Sequence[Model]) -> None:
        """The floor of the machine that has the best candidate, where that is the lower one."""
        if self.measure and not current.effects:
            best = min(fresh, key=lambda m: m.mean_square)
            self._beside = min(self._beside, self.measure(best.fit), key=lambda f: f.share)

    def _again(self, current: Model, passed: Sequence[Model]) -> Model:
        """The model fitted again from where the best candidate's fit ended, if that is better."""
        if not passed:
            return current
        best = min(passed, key=lambda m: m.mean_square)
        own = [n for e in best.effects if e not in current.effects for n in parameters_of(e)]
        found = again_from(self.train, current.fit, best.fit.changes, own, self.settings)
        if found is None:
            return current
        self._screened.pop(current.names, None)
        return self.added(current.effects, found)

    def _lead(self, passed: Sequence[Model]) -> None:
        """Fit the best, the next and the simplest within reach until they settle: a brief fit
        favours who has more numbers."""
        ranked = sorted(passed, key=lambda m: m.mean_square)
        within = [m for m in ranked if m.mean_square <= REACH * ranked[0].mean_square]
        simplest = sorted(within[LEADERS:], key=lambda m: (len(m.effects), m.numbers))[:1]
        for model in [*within[:LEADERS], *simplest]:
            self.settled(model)

    def settled(self, model: Model) -> Model:
        """The model fitted until it settles, from where it stands and from afar."""
        if self._settled.get(model.names) is model:
            return model
        enough = self._enough(self.floor_of(model).share)

        def complete(found: Fit) -> bool:
            return self._rmse(self.validate(found.changes)) <= enough

        found = to_the_end(self.train, model.effects, model.fit, self.settings, complete)
        self._settled[model.names] = self.added(model.effects, found)
        return self._settled[model.names]

    def related(self, effect: type[Effect], others: Sequence[type[Effect]]) -> bool:
        """Whether another law of dry friction is among the others."""
        return another_dry(effect, others)

    def plain(self, model: Model) -> bool:
        """Whether its waves say something that no smooth law would.

        Half a period of the slowest wave that bounds allow passes for a constant, a slope or a
        bend: the faster waves of its law have to count without it.
        """
        for effect in slowest(self.train, model.effects, model.fit):
            rest = tuple(e for e in model.effects if e is not effect)
            lesser = self.fitted(rest, model.fit.changes)
            faster = without_slowest(self.train, effect, model.fit, self.settings)
            left = modelled(model.effects, faster, self.residuals).mean_square
            if left + self.least**2 > lesser.mean_square:
                return False
        return True

    def complete(self, model: Model) -> bool:
        """Whether nothing more is to be looked for.

        Beside an effect that is where no more is left, the length included, than noise and builds
        account for; without any, where no effect could count.
        """
        if model.effects:
            enough = self._enough(self.floor_of(model).share)
            return bool(np.sqrt(model.mean_square) < enough)
        least = RESOLUTION if self.measure else self.settings.floor
        return not self.settings.always and self._missed(model) < least * self.size

    def finished(self, model: Model) -> Model:
        """The model fitted to the end, with intervals where they are wanted."""
        if not self.settings.intervals or model.names in self._done:
            return self.tried[model.names]
        self._done.add(model.names)
        found = lastly(self.train, self.tried[model.names].fit, self.settings, exact=True)
        return self.added(model.effects, found)

    def left(self, model: Model) -> Left:
        """What is left of a model above noise and floor, on trials that chose nothing."""
        floor, effort = self.floor_of(model).share, self.train.effort.name
        enough, square = self._enough(floor), model.heldout_square
        share, least = self._missed(model) / self.size, enough / self.size
        said = (
            f"Beside it {share:.1%} of the {effort} is left, more than the {least:.1%} that noise "
            "and builds account for: something else is missing, too, or its law is not quite the "
            "machine's."
        )
        unknown = (
            f"Something is missing that the library does not hold: {share:.1%} of the {effort}.",
            f"The model misses {share:.1%} of the {effort}'s RMS on trials that it was not fitted "
            "to, and no candidate explains enough of it to be likely. The regimes that hold the "
            "error say what it depends on.",
        )
        above = max(0.0, square - complete(self.heldout, floor) ** 2) / max(square, 1e-300)
        return Left(above, said if share > least else "", unknown)

    def lacks(self, bare: Model) -> bool:
        """Whether the fitted numbers alone leave more than noise and builds account for."""
        return not self._within(bare)

    def nothing(self, bare: Model) -> str:
        """Why nothing is missing, in a sentence."""
        floor, effort = self.floor_of(bare).share, self.train.effort.name
        return (
            f"With fitted numbers alone the model misses {self._missed(bare) / self.size:.1%} of "
            f"the {effort}'s RMS on trials that it was not fitted to; sensor noise and the "
            f"differences between two builds of the same machine account for up to "
            f"{self._enough(floor) / self.size:.1%}. No candidate that carries {floor:.1%} of the "
            f"{effort} is likely."
        )

    def without(self, names: Collection[str]) -> "Simulated":
        """The fit of the numbers alone and what was screened beside it, less these names.

        Every set is fitted anew: who leads, and the floor beside it, may be others.
        """
        other, bare = copy(self), frozenset[str]()
        other.tried = {bare: self.tried[bare]}
        known = self._screened.get(bare, {})
        other._screened = {bare: {n: s for n, s in known.items() if n not in names}}
        other._beside, other._done, other._settled = self._alone, {bare}, {}
        return other

    def scores(self, model: Model) -> dict[str, Score]:
        """Of the effort, by role."""
        return scores(model, self.residuals)

    def missed(self, model: Model) -> dict[str, np.ndarray]:
        """Model minus measurement by role, (N,) each."""
        others = {r: self.residuals[r](model.fit.changes) for r in ROLES if r != "train"}
        return {"train": model.fit.residual, **others}

    def _missed(self, model: Model) -> float:
        """RMS of what is missed of the effort itself, on the trials that decide."""
        return self._rmse(model.left * np.sqrt(np.mean(self.validate.rows)))

    def _rmse(self, values: np.ndarray) -> float:
        return rms(values[self.validate.rows])

    def _enough(self, floor: float) -> float:
        return complete(self.validate, floor)

    def _within(self, model: Model) -> bool:
        """Whether a model misses no more of the effort than noise and builds account for."""
        return self._missed(model) <= self._enough(self.floor_of(model).share)
