"""Sets of effects, fitted, and who fits them: all that the search knows of a machine.

Of the laws of dry friction, known by what their kernels do, a set holds one.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Protocol

import numpy as np

from spirob.effects import Effect
from spirob.identify.fit import Fit
from spirob.identify.problem import Problem, rms

ALIKE = 0.1  # of the floor: by no more may two models differ that say the same
ABSORBED = 1e-3  # share of an effect outside of what the fitted numbers make: below, it is of these
SPEEDS = {"motor.speed", "motor.rest_speed"}
SLOW, FAST = 1e3, 1e4  # rest speeds at which sliding friction has settled
LOW = (1.0, 3.0, 10.0)  # rest speeds among which a level is highest
HIGHER = 1.1
SETTLING = 100  # steps that a memory is given for that
STEP = 1.0  # s


class Scored:
    """What the questions of the search are asked of: a model, or a draft of a law.

    left     residual on data that the fit has not seen, (N,) in the unit of the effort
    errors   mean squares of these by block, and of the fitted ones where they count, too
    heldout  residual on the held-out trials, which choose nothing
    """

    left: np.ndarray
    errors: np.ndarray
    heldout: np.ndarray

    @property
    def mean_square(self) -> float:
        """Of the data that the fit has not seen."""
        return float(np.mean(self.left**2))

    @property
    def heldout_square(self) -> float:
        """Of the held-out trials."""
        return float(np.mean(self.heldout**2))


@dataclass(frozen=True, eq=False)
class Model(Scored):
    """A set of effects, fitted."""

    effects: tuple[type[Effect], ...]
    fit: Fit
    left: np.ndarray
    errors: np.ndarray
    heldout: np.ndarray

    @property
    def names(self) -> frozenset[str]:
        """Names of its effects."""
        return frozenset(e.name() for e in self.effects)

    @property
    def numbers(self) -> int:
        """How rich it is, by its effects."""
        return sum(map(richness, self.effects))


def richness(effect: type[Effect]) -> int:
    """Numbers of an effect, and one more where it has a memory.

    How many cells a memory takes is a matter of its program: a delay needs many, and one time.
    """
    return len(effect.parameters()) + bool(effect.state)


@dataclass(frozen=True)
class Offer:
    """An effect as the screening beside a model sees it.

    values   numbers to start a fit from, by full name, its own among them
    error    mean squared residual that it promises
    new      share of its columns that the fitted numbers cannot make
    """

    effect: type[Effect]
    values: dict[str, float]
    error: float
    new: float = 1.0


@dataclass(frozen=True)
class Left:
    """What is left of a model.

    share    of its squared error that is neither noise nor what such machines differ by
    said     a sentence, empty where there is nothing to say
    unknown  sentence and explanation of the verdict, where nothing that was found says it
    """

    share: float
    said: str
    unknown: tuple[str, str]


Counts = Callable[[Model, Model], bool]  # whether the second explains enough more than the first
Sets = Sequence[tuple["Offer", ...]]  # to add to a model, each at once


@dataclass
class Found:
    """What the search ends with.

    rungs        from the bare model to the chosen one, an effect at a time
    offers       all candidates screened beside the bare model, best first
    rivals       chosen effect -> others that take its place about as well
    equivalents  the same, of those that say the same
    vetoed       effects that the data left out wanted and the held-out trials did not
    """

    rungs: list[Model]
    offers: list[Offer] = field(default_factory=list)
    rivals: dict[str, list[str]] = field(default_factory=dict)
    equivalents: dict[str, list[str]] = field(default_factory=dict)
    vetoed: list[str] = field(default_factory=list)

    @property
    def chosen(self) -> Model:
        """The model that the search stands by."""
        return self.rungs[-1]


class Predictor(Protocol):
    """Fits sets of effects to a machine's trials, and keeps every model that it fitted.

    An arm is simulated (`simulated`), the inverse model of a rig is evaluated (`machine.models`).

    train, heldout  the trials that are fitted, and those that choose nothing
    names  of the numbers that every set fits
    size   RMS of the measured effort;  least  size of the least effect that counts, in its unit
    robust  error at which the loss of a fit turns from square to linear, in its unit
    tried  names of the effects -> model
    progress  is told each step of a search
    promised  share of the least effect that a screening has to promise for a fit to be worth it
    certainty  by which regression of `certainty` a name is likely
    """

    certainty: str = "name"
    train: Problem
    heldout: Problem
    progress: Callable[[str], None]
    names: list[str]
    size: float
    robust: float
    promised: float
    tried: dict[frozenset[str], Model]

    @property
    def least(self) -> float: ...

    def fitted(self, effects: tuple[type[Effect], ...], start: Mapping[str, float]) -> Model:
        """The model of a set; its numbers begin at `start`."""

    def grown(
        self, current: Model, sets: Sets, counts: Counts, near: "Model | None" = None
    ) -> list[Model]:
        """The model with each of these sets added, those that count fitted until they settle.

        They may begin at the numbers of another model that is `near`er than this one.

        Where one of them shows that the model itself was not fitted to its end, it is fitted again,
        and the other one stands in `tried`.
        """

    def offers(self, model: Model, effects: Sequence[type[Effect]]) -> list[Offer]:
        """The effects beside a model, the best first."""

    def pairs(self, model: Model, offers: Sequence[Offer]) -> list[tuple[float, Offer, Offer]]:
        """Pairs of these with the mean square that they promise together, the best first."""

    def related(self, effect: type[Effect], others: Sequence[type[Effect]]) -> bool:
        """Whether one of the others is the same kind of law, of which a machine has only one."""

    def absorbs(self, model: Model, effect: type[Effect]) -> bool:
        """Whether a model's numbers make all that an effect would do; False where unknown."""
        return False

    def plain(self, model: Model) -> bool:
        """Whether a model says something that no simpler words would."""

    def complete(self, model: Model) -> bool:
        """Whether no more is left than of a machine from which nothing is missing."""

    def finished(self, model: Model) -> Model:
        """The model with the intervals of its numbers."""

    def left(self, model: Model) -> Left:
        """What is left of a model."""

    def lacks(self, bare: Model) -> bool:
        """Whether the fitted numbers alone leave too much for a machine that misses nothing."""

    def nothing(self, bare: Model) -> str:
        """Why nothing is missing, in a sentence."""


def label(effects: Sequence[type[Effect]]) -> str:
    """A set of effects in a line."""
    return " + ".join(e.name() for e in effects) or "the fitted numbers alone"


def alike(one: Model, two: Model, least: float) -> bool:
    """Whether two models predict the same effort, within a tenth of the least effect's RMS."""
    difference = one.fit.residual - two.fit.residual
    return rms(difference) < ALIKE * least


def equivalents(
    chosen: Model, rivals: Sequence[Model], least: float
) -> tuple[list[str], list[str]]:
    """Names of the effects that say the same as the chosen one, and of those that are real rivals.

    A rival counts as itself once, though it may be met several times.
    """
    same: list[str] = []
    other: list[str] = []
    for rival in rivals:
        name = next(iter(rival.names - chosen.names))
        (same if alike(chosen, rival, least) else other).append(name)
    return sorted(set(same)), sorted(set(other) - set(same))


def is_constant(effect: type[Effect]) -> bool:
    """Whether it is one number, whatever the motion."""
    return effect.name() in ("constant_force", "current_offset")


def is_dry(effect: type[Effect]) -> bool:
    """Whether this is a law of dry friction by speed alone: level at speed, and odd in it.

    Asked of the kernel itself, so that it holds for effects that nobody here has seen.
    """
    reads = set(effect.reads.values())
    if effect.port != "motor.torque" or "motor.speed" not in reads or not reads <= SPEEDS:
        return False
    slow, fast, back = (_settled(effect, v) for v in (SLOW, FAST, -FAST))
    return abs(fast) > 0.0 and abs(fast - slow) < 1e-3 * abs(fast) and fast * back < 0.0


def falls(effect: type[Effect], numbers: Mapping[str, float] = MappingProxyType({})) -> bool:
    """Whether the level of a dry friction is higher at low speed than at high speed.

    numbers  by their names in the effect; nominal where none are given
    """
    low = max(abs(_settled(effect, speed, numbers)) for speed in LOW)
    return low > HIGHER * abs(_settled(effect, FAST, numbers))


def _settled(
    effect: type[Effect], speed: float, numbers: Mapping[str, float] = MappingProxyType({})
) -> float:
    given = {a: 1.0 if s == "motor.rest_speed" else speed for a, s in effect.reads.items()}
    given |= {f: p.nominal for f, p in effect.parameters().items()} | dict(numbers)
    given |= {"dt": STEP} if "dt" in effect.arguments() else {}
    memory = dict(effect.state)
    if not memory:
        return float(effect.kernel(**given))
    for _ in range(SETTLING):
        out = effect.kernel(**given, **memory)
        memory = dict(zip(memory, out[1:], strict=True))
    return float(out[0])


def another_dry(effect: type[Effect], others: Collection[type[Effect]]) -> bool:
    """Whether another law of dry friction is among the others, of which a machine has only one.

    The sum of two is a third one, with a transition that fits anything.  Only what they say of
    different things belongs together: how friction turns round at a reversal, and how its level
    falls with speed.
    """
    return is_dry(effect) and any(is_dry(o) and not _complete(effect, o) for o in others)


def _complete(one: type[Effect], other: type[Effect]) -> bool:
    """Whether one law tells how friction turns round, the other how its level falls with speed."""
    memory, level = (one, other) if one.state else (other, one)
    return bool(memory.state) and not level.state and falls(level)
