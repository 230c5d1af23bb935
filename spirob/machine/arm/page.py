"""What the page of an arm's diagnosis shows besides the document."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from spirob.diagnosis.rungs import Search
from spirob.identify.residual import Residual
from spirob.parameter import Table
from spirob.robot import MOTORS

PAGE_ROLES = {"heldout": "test", "train": "train"}


def overlay(search: Search, residuals: Mapping[str, Residual], named: bool) -> pd.DataFrame:
    """Current of each working motor, measured and modelled: bare, and with the named effects."""
    models = {"base": search.rungs[0], "named": search.rungs[-1 if named else 0]}
    parts = []
    for role, shown in PAGE_ROLES.items():
        residual = residuals[role]
        for k, trial in enumerate(residual.trials):
            found = {n: residual.respond(rung.fit.changes, k) for n, rung in models.items()}
            for m in residual.driven(trial):
                columns: dict[str, Any] = {"trial": trial.name, "role": shown}
                columns["time"] = trial.seconds[residual.cycles(trial)]
                columns["position"] = residual.thin(trial.displacement[:, m], trial)
                columns["measured"] = residual.thin(trial.current[:, m], trial)
                columns |= {n: residual.thin(r.current[:, m], trial) for n, r in found.items()}
                parts.append(pd.DataFrame(columns).assign(motor=MOTORS[m]))
    return pd.concat(parts, ignore_index=True)


def parameters(search: Search, table: Table) -> dict[str, Any]:
    """Fitted numbers of the bare model."""

    def reach(name: str) -> tuple[float, float]:
        return table.about[name].reach(float(table.values[table.position(name)]))

    return {
        name: {
            "value": e.value,
            "low": e.low,
            "high": e.high,
            "unit": e.unit,
            "nominal": table.about[name].nominal,
            "bound_low": reach(name)[0],
            "bound_high": reach(name)[1],
            "at_bound": e.at_bound,
            "meaning": table.about[name].meaning,
        }
        for name, e in search.rungs[0].fit.estimates.items()
    }
