"""An effect run over recorded signals: its contribution as a time series, of any motor rig."""

from collections.abc import Mapping

import numpy as np

from spirob.effects.effect import Effect
from spirob.errors import EffectError
from spirob.ports import PORTS


def contribution(
    effect: type[Effect],
    numbers: Mapping[str, float],
    signals: Mapping[str, np.ndarray | float],
    dt: float,
    upstream: np.ndarray | float | None = None,
) -> np.ndarray:
    """What the effect does at its port, sample by sample, from its initial state, (T,).

    numbers   by name; those not given are nominal
    signals   by the names of `ports.SIGNALS`: (T,) or one value for all samples;  dt [s]
    upstream  values that a pipe port is given; the result is then what the pipe makes of them

    Raises EffectError when a signal or the upstream values are missing.
    """
    who = f"effect '{effect.name()}'"
    if absent := [s for s in effect.reads.values() if s not in signals]:
        raise EffectError(f"{who} reads {', '.join(absent)}; given: {', '.join(signals)}")
    inputs = {a: signals[s] for a, s in effect.reads.items()}
    if PORTS[effect.port].combine == "pipe":
        if upstream is None:
            raise EffectError(f"{who} maps what comes from upstream at {effect.port}: give it")
        inputs["upstream"] = upstream
    nominal = {name: about.nominal for name, about in effect.parameters().items()}
    return run(effect, {**nominal, **numbers}, inputs, dt)[0]


def run(
    effect: type[Effect],
    numbers: Mapping[str, float],
    inputs: Mapping[str, np.ndarray | float],
    dt: float,
    state: Mapping[str, float] | None = None,
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Contributions and states after every sample, for kernel arguments given by name.

    state  where to begin, by default the effect's initial state
    """
    arrays = np.broadcast_arrays(*map(np.atleast_1d, inputs.values()))
    columns = dict(zip(inputs, (a.astype(float).tolist() for a in arrays), strict=True))
    samples = len(arrays[0]) if arrays else 1
    values: dict[str, float] = {**numbers, "dt": dt, **(state or effect.state)}
    order = effect.arguments()
    memory = list(effect.state)
    out = np.zeros(samples)
    trail = {name: np.zeros(samples) for name in memory}
    for k in range(samples):
        for name, column in columns.items():
            values[name] = column[k]
        result = effect.kernel(*(values[a] for a in order))
        if not memory:
            out[k] = result
            continue
        out[k] = result[0]
        for name, following in zip(memory, result[1:], strict=True):
            values[name] = following
            trail[name][k] = following
    return out, trail
