"""The held-out trials of an arm as plain data beside its diagnosis, and as trials again.

`rows` is the table of `heldout.parquet`: for each cycle the trial's number, whether it is compared,
and of each motor its signals and what holds the model to the log; `told` has what does not change
within a trial.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from spirob.control import MODES, Schedule
from spirob.identify.measurement import MEASURED, Measurement
from spirob.robot import MOTORS, Scene

PLAYED = ("reference", "reference_rate")
NAMES = {number: name for name, number in MODES.items()}


def rows(trials: Sequence[Measurement]) -> pd.DataFrame:
    """The trials, a row for each cycle."""
    parts = []
    for k, trial in enumerate(trials):
        own = {"trial": k, "use": True if trial.use is None else trial.use}
        both = {name: getattr(trial, name) for name in MEASURED}
        both |= {name: getattr(trial.schedule, name) for name in PLAYED}
        pairs = {
            f"{n} of {motor}": x[:, m] for n, x in both.items() for m, motor in enumerate(MOTORS)
        }
        parts.append(pd.DataFrame(pairs).assign(**own))
    return pd.concat(parts, ignore_index=True)


def told(trials: Sequence[Measurement]) -> list[dict[str, Any]]:
    """What stays the same in each trial."""
    return [
        {
            "name": t.name,
            "mode": [NAMES[int(mode)] for mode in t.schedule.mode],
            "current_limit": t.schedule.current_limit.tolist(),
            "held": None if t.schedule.held is None else t.schedule.held.tolist(),
            "first_angle": list(t.first_angle),
        }
        for t in trials
    ]


def again(table: pd.DataFrame, known: Sequence[Mapping[str, Any]]) -> list[Measurement]:
    """The trials of a table; raises KeyError, TypeError or ValueError where something is off."""
    found = []
    for k, about in enumerate(known):
        own = table[table["trial"] == k]
        both = {
            n: own[[f"{n} of {m}" for m in MOTORS]].to_numpy(float) for n in (*MEASURED, *PLAYED)
        }
        if not len(own) or not all(np.isfinite(x).all() for x in both.values()):
            raise ValueError(f"trial {k} has no finite rows")
        reference, rate = (both[name] for name in PLAYED)
        schedule = Schedule(
            np.array([MODES[mode] for mode in about["mode"]]),
            reference,
            rate,
            np.array(about["current_limit"], float),
            None if about["held"] is None else np.array(about["held"], float),
        )
        first = tuple(map(float, about["first_angle"]))
        use = own["use"].to_numpy(bool)
        current, displacement, velocity = (both[n] for n in MEASURED)
        signals = current, displacement, velocity
        trial = Measurement(str(about["name"]), "heldout", *signals, schedule, Scene(), first)
        found.append(replace(trial, use=use))
    return found
