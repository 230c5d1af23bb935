"""From trials to a table of features, one row for each wrap."""

from collections.abc import Iterable, Mapping, Sequence

import pandas as pd

from spirob.errors import ConfigError, DataError
from spirob.perceive import electromechanical, spectral, temporal
from spirob.perceive.wrap import FEATURES, Feature, feature, read_wrap
from spirob.trace import Trace


def extract(
    trace: Trace, motor: str = "left", names: Sequence[str] | None = None
) -> dict[str, float]:
    """Features of one wrap by name, in the units that `FEATURES` states.

    names  which ones, in this order; all where None
    Raises ConfigError on an unknown feature and what `read_wrap` raises; never returns a NaN.
    """
    for name in names or ():
        if name not in FEATURES:
            raise ConfigError(f"no feature '{name}'; known: {', '.join(FEATURES)}")
    wrap = read_wrap(trace, motor)
    values = {name: FEATURES[name].measure(wrap) for name in names or FEATURES}
    for name, value in values.items():
        if not abs(value) < float("inf"):
            raise DataError(f"{trace.name}: feature '{name}' is {value}, so this is no wrap")
    return values


def table(
    traces: Iterable[Trace], motor: str = "left", names: Sequence[str] | None = None
) -> pd.DataFrame:
    """Features of many wraps, indexed by trial, with the true diameter [m] as last column.

    The truth is read from the scene in `meta`.  Raises DataError where a trial has no cylinder
    and what `extract` raises.
    """
    rows = {}
    for trace in traces:
        if trace.name in rows:
            raise DataError(f"two wraps have the name '{trace.name}'")
        rows[trace.name] = {**extract(trace, motor, names), "diameter": true_diameter(trace)}
    out = pd.DataFrame.from_dict(rows, orient="index")
    out.index.name = "trial"
    return out


def true_diameter(trace: Trace) -> float:
    """Diameter [m] of the cylinder that the log says stood there; DataError where it says none."""
    scene = trace.meta.get("scene")
    cylinder = scene.get("cylinder") if isinstance(scene, Mapping) else None
    if not isinstance(cylinder, Mapping) or "diameter" not in cylinder:
        raise DataError(f"{trace.name}: its scene has no cylinder, so the true diameter is unknown")
    return float(cylinder["diameter"])


__all__ = [
    "FEATURES", "Feature", "electromechanical", "extract", "feature", "spectral", "table",
    "temporal", "true_diameter",
]  # fmt: skip
