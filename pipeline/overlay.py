"""Tables for the report: measured and modelled signals side by side, and the arm in motion.

For its switches every combination of the first candidates is played beforehand.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from pipeline.stage import workers
from spirob.diagnosis.model import Found, label
from spirob.diagnosis.screen import Alone, together, without
from spirob.diagnosis.simulated import Simulated
from spirob.effects import Effect
from spirob.files import replacing
from spirob.identify.residual import Residual
from spirob.robot import MOTORS

FRAMES_PER_SECOND = 30
CHANNELS = ("current", "displacement", "velocity")


def overlay(
    folder: Path,
    residuals: Mapping[str, Residual],
    base: Mapping[str, float],
    named: Mapping[str, float],
) -> None:
    """overlay.parquet: trials that no fit has seen, both sides filtered alike."""
    table = table_of(residuals, {"base": base, "named": named}, measured=True)
    write_table(folder / "overlay.parquet", table)


def table_of(
    residuals: Mapping[str, Residual],
    models: Mapping[str, Mapping[str, float]],
    measured: bool = False,
) -> pd.DataFrame:
    """Columns NAME_CHANNEL of each model, by its numbers, in the trials that no fit has seen.

    One row for each kept sample of each motor: trial, role, motor, time [s]; SI.
    measured  the robot's own signals besides
    """
    trials = [(r, k) for r in ("validate", "heldout") for k in range(len(residuals[r].trials))]
    jobs = [(role, k, changes) for role, k in trials for changes in models.values()]
    with ThreadPoolExecutor(workers()) as pool:  # the compiled loop runs without the GIL
        responses = iter(
            list(pool.map(lambda job: residuals[job[0]].respond(job[2], job[1]), jobs))
        )
    parts = []
    for role, k in trials:
        residual, trial = residuals[role], residuals[role].trials[k]
        sides: dict[str, Any] = {"measured": trial} if measured else {}
        sides |= {name: next(responses) for name in models}
        thin = residual.filter.thin
        for m, motor in enumerate(MOTORS):
            columns = {
                f"{side}_{channel}": thin(getattr(signals, channel)[:, m], trial.name)
                for channel in CHANNELS
                for side, signals in sides.items()
            }
            time = trial.seconds[:: residual.filter.every]
            about = {"trial": trial.name, "role": role, "motor": motor, "time": time}
            parts.append(pd.DataFrame(about | columns))
    return pd.concat(parts, ignore_index=True)


def motion(folder: Path, residuals: Mapping[str, Residual], changes: Mapping[str, float]) -> None:
    """motion.parquet: hinge angles of the best model in the held-out trials."""
    parts = []
    residual = residuals["heldout"]
    for k, trial in enumerate(residual.trials):
        angles = residual.respond(changes, k).angles
        rows = np.arange(0, len(angles), round(1000 / FRAMES_PER_SECOND))
        columns = {f"q{i}": angles[rows, i] for i in range(angles.shape[1])}
        parts.append(pd.DataFrame({"trial": trial.name, "time": rows * 1e-3} | columns))
    write_table(folder / "motion.parquet", pd.concat(parts, ignore_index=True))


def write_table(path: Path, table: pd.DataFrame) -> None:
    """Write a table whole or not at all."""
    with replacing(path) as temporary:
        table.to_parquet(temporary, compression="zstd", index=False)


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
