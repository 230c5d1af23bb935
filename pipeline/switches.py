"""What the report's switches show: every combination of the first candidates, played beforehand."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np
import pandas as pd

from pipeline.overlay import CHANNELS, table_of, write_table
from spirob.diagnosis.model import label
from spirob.diagnosis.screen import without
from spirob.diagnosis.search import Found
from spirob.diagnosis.simulated import Simulated
from spirob.diagnosis.together import Alone, together
from spirob.effects import Effect

MOST = 5  # candidates: 31 combinations
SHOWN = 2  # candidates whose law is drawn where none is named


@dataclass(frozen=True)
class Played:
    """A model to play: its effects, its numbers, and where they come from.

    how  "refitted" in full simulation, "screened", or "replayed": to first order from those alone
    """

    effects: tuple[type[Effect], ...]
    changes: Mapping[str, float]
    how: str


def switches(folder: Path, search: Simulated, found: Found) -> None:
    """combinations.parquet: responses of all combinations; rows are the overlay's.

    Nothing is written where no candidate passed the screening.
    """
    alone, parts = candidates(search, found), []
    for model in models(search, found, alone):
        rows = table_of(search.residuals, {"": model.changes})
        rows = rows.rename(columns={f"_{channel}": channel for channel in CHANNELS})
        rows[list(CHANNELS)] = rows[list(CHANNELS)].astype(np.float32)
        rows.insert(0, "effects", label(model.effects))
        parts.append(rows.assign(how=model.how))
    if parts:
        whole = pd.concat(parts, ignore_index=True)
        named = ["effects", "trial", "role", "motor", "how"]
        whole[named] = whole[named].astype("category")
        write_table(folder / "combinations.parquet", whole)


def candidates(search: Simulated, found: Found) -> list[Alone]:
    """The candidates that were fitted alone, the best first, then the next best of the screening.

    Up to `MOST`.
    """
    promised = {o.effect.name(): o for o in found.offers}
    fitted = [m for m in search.tried.values() if len(m.effects) == 1 and m.names <= {*promised}]
    ranked = sorted(fitted, key=lambda m: m.mean_square)[:MOST]
    alone = [Alone(m.effects[0], m.fit.changes, m.fit.residual) for m in ranked]
    known, bare = {one.effect for one in alone}, found.rungs[0].mean_square
    rest = [o for o in found.offers if o.effect not in known and o.error < bare]
    for offer in rest[: MOST - len(alone)]:
        alone.append(Alone(offer.effect, offer.values, search.train(offer.values), False))
    return alone


def models(search: Simulated, found: Found, alone: Sequence[Alone]) -> list[Played]:
    """One for every combination, fewer effects first."""
    made = [
        Played((one.effect,), one.changes, "refitted" if one.refitted else "screened")
        for one in alone
    ]
    base, scale = found.rungs[0].fit, search.settings.scale
    for count in range(2, len(alone) + 1):
        for chosen in combinations(alone, count):
            effects = tuple(one.effect for one in chosen)
            numbers = together(search.train, base, chosen, scale)
            made.append(Played(effects, numbers, "replayed"))
    return made


def laws(folder: Path, search: Simulated, found: Found, named: bool) -> None:
    """laws.parquet: each effect's model with and without it, all else as fitted.

    named  the effects that were found; otherwise the first candidates, each in its own model
    """
    shown: list[tuple[type[Effect], Mapping[str, float]]]
    if named:
        shown = [(e, found.chosen.fit.changes) for e in found.chosen.effects]
    else:
        shown = [(one.effect, one.changes) for one in candidates(search, found)[:SHOWN]]
    parts = []
    for effect, changes in shown:
        off = without(effect, changes, search.train)
        rows = table_of(search.residuals, {"with": changes, "without": off})
        parts.append(rows.assign(effect=effect.name()))
    if parts:
        write_table(folder / "laws.parquet", pd.concat(parts, ignore_index=True))
