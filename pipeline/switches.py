"""What the report's switches show: every combination of the first candidates, played beforehand."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np
import pandas as pd

from pipeline.overlay import CHANNELS, table_of, write_table
from spirob.diagnosis.confirm import Alone, together
from spirob.diagnosis.rungs import Ladder, label
from spirob.diagnosis.screen import without
from spirob.effects import Effect
from spirob.identify.residual import Residual

MOST = 5  # candidates: 31 combinations
SHOWN = 2  # candidates whose law is drawn where none is named


@dataclass(frozen=True)
class Model:
    """A model to play: its effects, its numbers, and where they come from.

    how  "refitted" in full simulation, "screened", or "replayed": to first order from those alone
    """

    effects: tuple[type[Effect], ...]
    changes: Mapping[str, float]
    how: str


def switches(folder: Path, residuals: Mapping[str, Residual], search: Ladder, scale: float) -> None:
    """combinations.parquet: responses of all combinations; rows are the overlay's.

    Nothing is written where no candidate passed the screening.
    """
    alone = candidates(residuals["train"], search)
    parts = []
    for model in models(residuals["train"], search, alone, scale):
        rows = table_of(residuals, {"": model.changes})
        rows = rows.rename(columns={f"_{channel}": channel for channel in CHANNELS})
        rows[list(CHANNELS)] = rows[list(CHANNELS)].astype(np.float32)
        rows.insert(0, "effects", label(model.effects))
        parts.append(rows.assign(how=model.how))
    if parts:
        whole = pd.concat(parts, ignore_index=True)
        named = ["effects", "trial", "role", "motor", "how"]
        whole[named] = whole[named].astype("category")
        write_table(folder / "combinations.parquet", whole)


def candidates(train: Residual, search: Ladder) -> list[Alone]:
    """The finalists of the first round, and the next best of its screening, up to `MOST`."""
    confirmed = [c for c in (search.rounds[0] if search.rounds else []) if len(c.effects) == 1]
    found = [Alone(c.effects[0], c.fit.changes, c.fit.residual) for c in confirmed]
    if not found:
        return []
    known = {one.effect for one in found}
    rest = [s for s in search.screened[0] if s.effect not in known and s.gain > 0.0]
    for screened in rest[: MOST - len(found)]:
        found.append(Alone(screened.effect, screened.changes, train(screened.changes), False))
    return found[:MOST]


def models(train: Residual, search: Ladder, alone: Sequence[Alone], scale: float) -> list[Model]:
    """One for every combination, fewer effects first."""
    found = [
        Model((one.effect,), one.changes, "refitted" if one.refitted else "screened")
        for one in alone
    ]
    base = search.rungs[0].fit
    for count in range(2, len(alone) + 1):
        for chosen in combinations(alone, count):
            effects = tuple(one.effect for one in chosen)
            found.append(Model(effects, together(train, base, chosen, scale), "replayed"))
    return found


def laws(folder: Path, residuals: Mapping[str, Residual], search: Ladder, named: bool) -> None:
    """laws.parquet: each effect's model with and without it, all else as fitted.

    named  the effects of the last rung; otherwise the first candidates, each in its own model
    """
    shown: list[tuple[type[Effect], Mapping[str, float]]]
    if named:
        shown = [(e, search.rungs[-1].fit.changes) for e in search.rungs[-1].effects]
    else:
        alone = candidates(residuals["train"], search)
        shown = [(one.effect, one.changes) for one in alone[:SHOWN]]
    parts = []
    for effect, changes in shown:
        off = without(effect, changes, residuals["train"])
        rows = table_of(residuals, {"with": changes, "without": off})
        parts.append(rows.assign(effect=effect.name()))
    if parts:
        write_table(folder / "laws.parquet", pd.concat(parts, ignore_index=True))
