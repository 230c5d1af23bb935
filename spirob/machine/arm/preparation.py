"""What the search on an arm's logs stands on: where they begin, its shape, the rows that count.

The usual numbers are fitted first.  Where they leave no more than a complete model does, or explain
next to nothing, nothing else is asked.  Otherwise the arm may be of another design, or buckle, and
not only lack an effect: its shape is searched for (`shape`) and believed where that clearly pays,
and what builds of this arm leave open is left out of all roles (`determined`).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import median

import numpy as np

from spirob.diagnosis.criteria import Settings, complete
from spirob.diagnosis.fitting import roughly
from spirob.identify.builds import (
    RESOLUTION,
    SCATTER,
    TOLERANCES,
    Builds,
    Floor,
    floor_of,
    weighted,
)
from spirob.identify.descent import robust_cost
from spirob.identify.fit import STEPS, Fit
from spirob.identify.residual import SENSE, Residual, explained, near
from spirob.machine.arm.rest import is_unsure, rested
from spirob.machine.arm.rows import determined
from spirob.machine.arm.shape import FREED, gate, searched_shape

NEARLY = 3.0  # times the error of a complete model: who leaves more than that misses something
PAYS = 0.8  # of the cost without: another shape is believed below that
ROUNDS = 3  # of a fit to where logs begin, and of where they begin to the fit


@dataclass(frozen=True)
class Settled:
    """What a search stands on.

    numbers    fitted ones, and those of another shape, which the search holds
    residuals  by role, of the rows that count
    floor      what builds of this arm differ by
    as_drawn   nothing else was asked
    said       sentences about all this
    """

    numbers: dict[str, float]
    residuals: dict[str, Residual]
    floor: Floor
    said: list[str]
    as_drawn: bool = False


@dataclass(frozen=True)
class Arm:
    """An arm as its logs show it: numbers, those fitted, and the rows that count, by role."""

    numbers: dict[str, float]
    names: list[str]
    residuals: dict[str, Residual]
    shares: dict[str, float]


@dataclass(frozen=True)
class Ground:
    """The logs by role, and how they are fitted.

    names  of the usual numbers;  free  those of a shape and of a build that may be asked for
    """

    residuals: Mapping[str, Residual]
    names: Sequence[str]
    free: Sequence[str]
    settings: Settings
    progress: Callable[[str], None]

    @property
    def train(self) -> Residual:
        """The trials that are fitted."""
        return self.residuals["train"]

    @property
    def limit(self) -> float:
        """By how much builds may be apart in a row that counts [A]."""
        return complete(self.train, self.settings.floor)

    def begun(self, changes: Mapping[str, float], read: "Ground") -> "Ground":
        """The same with logs that begin where the arm rests with these numbers.

        read  with the currents at their beginnings as they were read
        """
        roles = self.residuals.items()
        kept = {role: rested(of, changes, read.residuals[role]) for role, of in roles}
        return replace(self, residuals=kept)

    def rested(self, found: Fit) -> tuple["Ground", Fit]:
        """The same with logs that begin where the arm rests, and the fit to them, from this one."""
        ground, names = self, list(found.estimates)
        if any(map(is_unsure, self.residuals.values())):
            for _ in range(ROUNDS):
                ground = ground.begun(found.changes, self)
                found = roughly(ground.train, names, found.changes, ground.settings)
        return ground, found

    def floor(self, arm: Arm, told: Mapping[str, float]) -> Floor:
        """What builds differ by on the rows that count; where the holes lie is a part of the shape.

        told  by the logs of a build, at 95 %
        """
        kept, rules = arm.residuals, self.settings
        widths = {n: told.get(n, w) for n, w in TOLERANCES.items() if n in self.free}
        builds = Builds(arm.numbers, arm.names, rules.scale, widths, single=False)
        return floor_of(kept["train"], kept["validate"], builds)

    def on_its_rows(self, numbers: dict[str, float], names: list[str]) -> Arm:
        """The arm with these numbers, without what its builds leave open."""
        kept, shares = {}, {}
        for role, residual in self.residuals.items():
            trials, shares[role] = determined(residual, numbers, self.limit)
            kept[role] = replace(residual, trials=trials)
        return Arm(numbers, names, kept, shares)

    def weighed(self, numbers: dict[str, float], names: list[str]) -> Arm:
        """The arm with these numbers, each row weighted by what its hinges' scatter leaves open."""
        builds = Builds(numbers, names, self.settings.scale, {}, single=False)
        kept = weighted(self.residuals, builds, complete(self.train, RESOLUTION))
        return Arm(numbers, names, kept, {})

    def shaped(self, found: Fit) -> tuple[dict[str, float], list[str]]:
        """Numbers with the shape that is searched for from this fit, where that pays, and names of
        those fitted."""
        scale, names = self.settings.scale, list(found.estimates)
        numbers = found.changes
        if self.free:
            freed = [*names, *(n for n in FREED if n in self.free and n not in names)]
            other = searched_shape(self.train, found, self.free, scale, self.progress)
            shaped = roughly(self.train, freed, other, self.settings, STEPS)
            if shaped.cost < PAYS * found.cost:
                numbers, names = shaped.changes, freed
        return numbers, names


def settled(
    residuals: Mapping[str, Residual],
    names: Sequence[str],
    start: Mapping[str, float],
    free: Sequence[str],
    settings: Settings,
    progress: Callable[[str], None],
) -> Settled:
    """Shape and rows that count, with numbers fitted from where they start; the floor there.

    names  of the numbers;  free  those of `SHAPE` and `TOLERANCES` that may be searched for
    """
    ground = Ground(residuals, names, free, settings, progress)
    ground, found = ground.rested(roughly(ground.train, names, start, settings, STEPS[:1]))
    shares = list(explained(ground.train, found.residual).values())
    senseless = bool(shares) and median(shares) < SENSE  # no shape makes up for a wrong column
    if senseless or _left(ground.train, found.residual) <= NEARLY * ground.limit:
        found = roughly(ground.train, names, found.changes, ground.settings)
        whole = Arm(found.changes, list(names), dict(ground.residuals), {})
        floor = ground.floor(whole, {})
        nearly = _left(ground.train, found.residual) <= complete(ground.train, floor.share)
        if senseless or nearly:
            return Settled(found.changes, whole.residuals, floor, [], as_drawn=True)
    arm = ground.on_its_rows(*ground.shaped(found))
    numbers, widths, told = _built(ground, arm)
    floor = ground.floor(replace(arm, numbers=numbers), widths)
    said = [*_shape_told(arm, names, ground.train), *_rows_told(arm, ground), *told]
    return Settled(numbers, arm.residuals, floor, said)


def settled_with(
    residuals: Mapping[str, Residual],
    contender: Fit,
    free: Sequence[str],
    settings: Settings,
    progress: Callable[[str], None],
) -> Settled:
    """The same for an arm with an effect, whose fit this is.

    Under an effect an arm may buckle elsewhere.  So its shape is searched for with the effect, and
    each row weighs by what builds with the effect leave open: of rows that none of them leaves open
    there may be too few to decide.
    """
    names = list(contender.estimates)
    read = Ground(residuals, names, free, settings, progress)
    ground = read.begun(contender.changes, read)
    first = ground.weighed(contender.changes, names)
    here = replace(ground, residuals=first.residuals)
    found = roughly(here.train, names, contender.changes, settings)
    arm = ground.weighed(*here.shaped(found))
    numbers, widths, told = _built(ground, arm)
    floor = ground.floor(replace(arm, numbers=numbers), widths)
    said = [*_shape_told(arm, names, ground.train), *told]
    return Settled(numbers, arm.residuals, floor, said)


def _built(ground: Ground, arm: Arm) -> tuple[dict[str, float], dict[str, float], list[str]]:
    """The numbers with what of the build the logs tell, where that pays; of all that is not known
    of the build the 95 % half widths, beside the logs; and what the gate says."""
    asked, rules = [n for n in TOLERANCES if n in ground.free], ground.settings
    if not asked:
        return arm.numbers, {}, []
    train, numbers = arm.residuals["train"], arm.numbers
    close = near(train, numbers)
    told = gate(close, list(dict.fromkeys([*arm.names, *asked])), numbers, asked, rules.scale)
    if new := [n for n in told.seen if n not in arm.names]:
        built = roughly(train, [*arm.names, *new], numbers, rules)
        if built.cost < PAYS * robust_cost(close(numbers), rules.scale):
            numbers = built.changes
    return numbers, {**told.seen, **told.held}, told.told(numbers, train.table)


def _left(of: Residual, missed: np.ndarray) -> float:
    return float(np.sqrt(np.mean(missed[of.rows] ** 2)))


def _rows_told(arm: Arm, ground: Ground) -> list[str]:
    return [
        f"{', '.join(t.name for t in arm.residuals[role].trials)}: {share:.0%} of the rows count; "
        f"in the others arms of this kind whose hinges differ by {SCATTER:.0%} are apart by more "
        f"than {ground.train.effort.shown(ground.limit)}."
        for role, share in arm.shares.items()
        if share < 1.0
    ]


def _shape_told(arm: Arm, names: Sequence[str], train: Residual) -> list[str]:
    values = []
    for name in [n for n in FREED if n in arm.names and n not in names]:
        about = train.table.about[name]
        unit = "" if about.unit == "1" else f" {about.unit}"
        values.append(f"{about.meaning}: {arm.numbers[name]:.3g}{unit}")
    return [f"The arm is not as drawn, its logs say ({'; '.join(values)})."] if values else []
