"""What the search on an arm's logs stands on: the arm's shape, and the rows that count.

The usual numbers are fitted first.  Where they leave no more than a complete model does, nothing
else is asked.  Otherwise the arm may be of another design, or buckle, and not only lack an effect:
its shape is searched for (`shape`) and believed where that clearly pays, and what builds of this
arm leave open is left out of all roles (`determined`).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spirob.diagnosis.evidence import complete
from spirob.diagnosis.rungs import Settings
from spirob.identify.descent import robust_cost
from spirob.identify.fit import STEPS, Fit, fit
from spirob.identify.residual import Residual, near
from spirob.machine.arm.rows import SCATTER, determined
from spirob.machine.arm.shape import FREED, searched_shape
from spirob.machine.arm.tolerated import TOLERANCES, gate

PAYS = 0.8  # of the cost without: another shape is believed below that
OTHER_DESIGN = 0.01  # smallest effect that counts there, as on any rig that is not our arm


@dataclass(frozen=True)
class Settled:
    """What a search stands on.

    numbers    fitted ones, and those of another shape
    residuals  by role, of the rows that count
    said       sentences about both
    """

    numbers: dict[str, float]
    residuals: dict[str, Residual]
    said: list[str]


def settled(
    residuals: Mapping[str, Residual],
    names: Sequence[str],
    start: Mapping[str, float],
    free: Sequence[str],
    settings: Settings,
    progress: Callable[[str], None],
) -> Settled:
    """Shape and rows that count, with numbers fitted from where they start.

    names  of the numbers;  free  those of `SHAPE` and `TOLERANCES` that may be searched for
    """
    train, said = residuals["train"], []
    enough = complete(train, settings.floor)
    found = _fitted(train, names, start, settings)
    if np.sqrt(np.mean(found.residual[train.rows] ** 2)) <= enough:
        return Settled(found.changes, dict(residuals), [])
    if free:
        other = _shaped(train, names, found, free, settings, progress)
        if other.cost < PAYS * found.cost:
            found = other
            said.append(_told(other, [n for n in FREED if n in free], train))
    kept = {}
    for role, residual in residuals.items():
        trials, share = determined(residual, found.changes, enough)
        kept[role] = replace(residual, trials=trials)
        if share < 1.0:
            said.append(
                f"{', '.join(t.name for t in trials)}: {share:.0%} of the rows count; in the "
                f"others arms of this kind whose hinges differ by {SCATTER:.0%} are apart by more "
                f"than {residual.effort.shown(enough)}."
            )
    numbers = found.changes
    if free:
        numbers, told = _built(kept["train"], names, numbers, free, settings)
        said += told
    return Settled(numbers, kept, said)


def _shaped(
    train: Residual,
    names: Sequence[str],
    found: Fit,
    free: Sequence[str],
    settings: Settings,
    progress: Callable[[str], None],
) -> Fit:
    """The fit from the shape that was searched for."""
    freed = [*names, *(n for n in FREED if n in free and n not in names)]
    start = searched_shape(train, found, free, settings.scale, progress)
    return _fitted(train, freed, start, settings)


def _built(
    train: Residual,
    names: Sequence[str],
    numbers: Mapping[str, float],
    free: Sequence[str],
    settings: Settings,
) -> tuple[dict[str, float], list[str]]:
    """The numbers with what of the build the logs tell, where that pays, and what the gate says."""
    asked = [n for n in TOLERANCES if n in free]
    close = near(train, numbers)
    told = gate(close, list(dict.fromkeys([*names, *asked])), numbers, asked, settings.scale)
    if told.seen:
        freed = list(dict.fromkeys([*names, *told.seen]))
        built = fit(close, freed, numbers, settings.scale, settings.patience, exact=False)
        if built.cost < PAYS * robust_cost(close(numbers), settings.scale):
            return built.changes, told.told(built.changes, train.table)
    return dict(numbers), told.told(numbers, train.table)


def of_design(settings: Settings, numbers: Mapping[str, float]) -> Settings:
    """The settings for an arm with these numbers: those of ours, or of another design."""
    if not any(name.startswith("holes.") for name in numbers):
        return settings
    return replace(settings, floor=max(settings.floor, OTHER_DESIGN))


def _fitted(
    train: Residual, names: Sequence[str], start: Mapping[str, float], settings: Settings
) -> Fit:
    close = near(train, start)
    return fit(close, names, start, settings.scale, settings.patience, steps=STEPS, exact=False)


def _told(found: Fit, freed: Sequence[str], train: Residual) -> str:
    values = []
    for name in freed:
        about = train.table.about[name]
        unit = "" if about.unit == "1" else f" {about.unit}"
        values.append(f"{about.meaning}: {found.changes[name]:.3g}{unit}")
    return f"The arm is not as drawn, its logs say ({'; '.join(values)})."
