"""Signals on which effects are run: recorded ones, or plausible ones for a check.

Run over recorded signals, an effect gives its contribution as a time series, of any motor rig.
"""

from collections.abc import Iterator, Mapping
from itertools import product

import numpy as np

from spirob.effects.effect import Effect
from spirob.errors import EffectError
from spirob.parameter import Parameter
from spirob.ports import PORTS, SIGNALS

RATE_OF = {  # position -> its rate
    "motor.angle": "motor.speed",
    "winch.angle": "motor.speed",
    "winch.displacement": "winch.velocity",
    "hinge.angle": "hinge.speed",
}
RATES = {"motor.speed", "winch.velocity", "hinge.speed", "guide.sliding"}
HARMONICS = 4
CORNERS = 6  # numbers whose bounds are combined exhaustively; the rest are drawn

Inputs = dict[str, np.ndarray]


def spans(effect: type[Effect]) -> dict[str, tuple[float, float]]:
    """Plausible lowest and highest value of each of the kernel's inputs.

    Those of the motion that taught the law, where it says so.
    """
    out = {a: effect.taught.get(a, SIGNALS[s].span) for a, s in effect.reads.items()}
    if PORTS[effect.port].combine == "pipe":
        out["upstream"] = PORTS[effect.port].span
    return out


def speed_argument(effect: type[Effect]) -> str | None:
    """The kernel's argument that is a rate, if it reads one."""
    return next((a for a, s in effect.reads.items() if s in RATES), None)


def position_argument(effect: type[Effect]) -> str | None:
    """The kernel's argument whose rate it reads as well, if any."""
    read = set(effect.reads.values())
    return next((a for a, s in effect.reads.items() if RATE_OF.get(s) in read), None)


def points(effect: type[Effect], rng: np.random.Generator, count: int) -> Inputs:
    """Independent inputs, (count,) each, over the whole span and near its middle alike."""
    return {a: _draw(span, rng, count) for a, span in spans(effect).items()}


def extremes(effect: type[Effect], rng: np.random.Generator, samples: int) -> Inputs:
    """Inputs, (samples,) each, that jump between the ends, the middle and zero of their spans."""
    out = {}
    for argument, (low, high) in spans(effect).items():
        ends = [low, high, 0.5 * (low + high), *([0.0] if low <= 0.0 <= high else [])]
        out[argument] = rng.choice(ends, samples)
    return out


def motion(
    effect: type[Effect], rng: np.random.Generator, samples: int, dt: float, periods: int = 1
) -> Inputs:
    """Smooth inputs, (periods·samples,), repeating after `samples`; positions follow their rates.

    What belongs to the machine, such as a hinge's stiffness, is constant.
    """
    out: Inputs = {}
    for argument, span in spans(effect).items():
        signal = SIGNALS.get(effect.reads.get(argument, ""))
        level = _draw(span, rng, 1)[0]
        given = signal is not None and signal.given
        out[argument] = np.full(samples, level) if given else _smooth(span, rng, samples)
    speed, position = speed_argument(effect), position_argument(effect)
    if speed is not None:
        out[speed] = out[speed] - out[speed].mean()
    if speed is not None and position is not None:
        reach = spans(effect)[position][1]
        path = np.cumsum(out[speed]) * dt
        shrink = min(1.0, reach / (np.abs(path).max() + 1e-300))
        out[speed], out[position] = out[speed] * shrink, path * shrink
    return {a: np.tile(values, periods) for a, values in out.items()}


def steady(effect: type[Effect], inputs: Inputs, rng: np.random.Generator) -> Inputs:
    """The same inputs with everything constant but the speed and its position."""
    moving = {speed_argument(effect), position_argument(effect)}
    drawn = points(effect, rng, 1)
    return {
        a: values if a in moving else np.full(len(values), drawn[a][0])
        for a, values in inputs.items()
    }


def corners(effect: type[Effect], rng: np.random.Generator) -> Iterator[dict[str, float]]:
    """Every combination of bounds of the first numbers, with the others drawn."""
    about = effect.parameters()
    first = list(about)[:CORNERS]
    for chosen in product(*((about[n].low, about[n].high) for n in first)):
        yield {**drawn(effect, rng), **dict(zip(first, chosen, strict=True))}


def drawn(effect: type[Effect], rng: np.random.Generator) -> dict[str, float]:
    """Numbers drawn from their whole box."""
    return {name: _within(about, rng.uniform()) for name, about in effect.parameters().items()}


def typical(effect: type[Effect], rng: np.random.Generator) -> dict[str, float]:
    """Numbers within a factor of two of nominal; amplitudes away from neutral."""
    out = {}
    for name, about in effect.parameters().items():
        value = about.nominal if name not in effect.neutral else amplitude(effect, name)
        out[name] = float(np.clip(value * rng.uniform(0.5, 2.0), about.low, about.high))
    return out


def amplitude(effect: type[Effect], name: str) -> float:
    """A typical size of an amplitude, also of one whose nominal value is its neutral one."""
    about, neutral = effect.parameters()[name], effect.neutral[name]
    if about.nominal != neutral:
        return about.nominal
    others = (effect.parameters()[n] for n in effect.neutral)
    shares = [abs(p.nominal) / p.high for p in others if p.nominal and p.high > 0]
    return neutral + (shares[0] if shares else 0.1) * (about.high - neutral)


def _within(about: Parameter, share: float) -> float:
    if about.log:
        return float(about.low * (about.high / about.low) ** share)
    return float(about.low + share * (about.high - about.low))


def _draw(span: tuple[float, float], rng: np.random.Generator, count: int) -> np.ndarray:
    low, high = span
    if low < 0.0 < high:  # zoom in on zero, where signs turn round
        zoom = 10.0 ** rng.uniform(-4.0, 0.0, count)
        return rng.uniform(low, high, count) * zoom
    return rng.uniform(low, high, count)


def _smooth(span: tuple[float, float], rng: np.random.Generator, samples: int) -> np.ndarray:
    low, high = span
    turn = 2 * np.pi * np.arange(samples) / samples
    waves = [np.sin(k * turn + rng.uniform(0, 2 * np.pi)) / k for k in range(1, HARMONICS + 1)]
    sizes = rng.uniform(0.3, 1.0, HARMONICS)
    wave = np.tensordot(sizes, np.array(waves), 1)
    wave /= np.abs(wave).max()
    middle = 0.0 if low < 0.0 < high else (0.25 * high if low == 0.0 else 0.5 * (low + high))
    reach = 0.5 * (high - low)
    return np.clip(middle + reach * wave, low, high)  # clipped: a tendon goes slack


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
