"""Where to start an effect's shape numbers: those that do not make it vanish.

An amplitude can be found by regression from anywhere, a shape cannot: a ripple's order fitted from
a wrong start stays wrong.  So shapes start from a grid, and numbers that count periods of an angle
from the peaks of the residual's spectrum over that angle, those of a disc also from its turn.

Of the waves that a model was fitted with, it is told which are one wave, and which are none.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import combinations, product
from math import prod
from typing import TYPE_CHECKING

import numpy as np

from spirob.diagnosis.model import Model
from spirob.diagnosis.orders import peaks
from spirob.effects import Effect
from spirob.identify.fit import Fit
from spirob.machine.inverse.kernel_loop import is_pipe
from spirob.parameter import Parameter
from spirob.ports import SIGNALS

if TYPE_CHECKING:
    from spirob.machine.inverse.scaling import Sizes

MOST = 12  # combinations of one effect
DRAWS = 30  # of all that a kernel is given, over six decades, to see what matters to it
WIDE = 30.0  # bounds further apart than this factor are walked by ratio


def starts(
    effect: type[Effect],
    about: Mapping[str, Parameter],
    residual: np.ndarray,
    signals: Mapping[str, np.ndarray],
) -> list[dict[str, float]]:
    """Shape numbers to try, field -> value; one empty entry where there is no shape.

    residual  (N,) along the trials;  signals  of the motion and the effort there
    """
    fields = [f for f in about if f not in effect.neutral]
    count = 5 if len(fields) == 1 else 3
    grids = [places(effect, about[f], f, count, residual, signals) for f in fields]
    combined = [dict(zip(fields, at, strict=True)) for at in product(*grids)]
    return combined[:: max(1, -(-len(combined) // MOST))]


def places(
    effect: type[Effect],
    about: Parameter,
    field: str,
    count: int,
    residual: np.ndarray,
    signals: Mapping[str, np.ndarray],
) -> list[float]:
    """Values to try of one shape number: peaks of the spectrum, or `count` from bound to bound."""
    if not counts_periods(effect, field):
        return grid(about, count)
    wave = residual * _carrier(effect, signals)
    orders = peaks(wave, signals["angle"], about.low, about.high)
    turns = {about.nominal, 1.0} if reads_a_disc(effect) else set()
    return [*sorted(turns), *orders]


def _carrier(effect: type[Effect], signals: Mapping[str, np.ndarray]) -> np.ndarray:
    """What a wave of this effect is multiplied by on its way to the residual, (N,).

    The spectrum of an effort that ripples in proportion to itself has side bands in place of the
    ripple's order; multiplied by the effort once more, it shows the order.
    """
    if effect.port in ("motor.drive_torque", "winch.efficiency"):
        return signals["effort"]
    if effect.port == "sensing.displacement":  # read as acceleration: in proportion to speed²
        return np.asarray(signals["speed"] ** 2)
    return np.ones_like(signals["angle"])


def grid(about: Parameter, count: int) -> list[float]:
    """Values from bound to bound, the nominal one among them, by ratio where they span decades."""
    if about.low > 0 and about.high / about.low > WIDE:
        values = np.geomspace(about.low, about.high, count + 2)[1:-1]
    else:
        values = np.linspace(about.low, about.high, count + 2)[1:-1]
    return sorted({about.nominal, *(float(v) for v in values)})


def counts_periods(effect: type[Effect], field: str) -> bool:
    """Whether this number is an order N: the kernel repeats when the angle it reads grows by 2π/N.

    Asked of the kernel itself, so that it holds for effects that nobody here has seen.
    """
    if not _angles(effect) or effect.state:
        return False
    rng = np.random.default_rng(0)
    # a second wave may have any ratio to the first; what comes round is that of a whole number
    values = {
        f: rng.uniform(0.2, 0.8) * (p.high - p.low) + p.low
        if f in (field, *effect.neutral)
        else p.nominal
        for f, p in effect.parameters().items()
    }
    return _repeats(effect, values, values[field])


def _repeats(effect: type[Effect], numbers: Mapping[str, float], order: float) -> bool:
    """Whether the kernel comes round with so many periods a turn, and is not the same all along."""
    angles, rng = _angles(effect), np.random.default_rng(0)
    values = dict(numbers)
    values |= {argument: rng.uniform(0.5, 1.5) for argument in effect.reads}
    values |= {"upstream": 1.0} if is_pipe(effect) else {}
    values |= {"dt": 1e-3} if "dt" in effect.arguments() else {}
    turned = {**values, angles[0]: values[angles[0]] + 2 * np.pi / order}
    half = {**values, angles[0]: values[angles[0]] + 2 * np.pi / (2.7 * order)}
    here = effect.kernel(**values)
    scale = abs(here) + 1e-12
    repeats = abs(effect.kernel(**turned) - here) < 1e-9 * scale
    return bool(repeats and abs(effect.kernel(**half) - here) > 1e-6 * scale)


def _angles(effect: type[Effect]) -> list[str]:
    return [a for a, signal in effect.reads.items() if SIGNALS[signal].unit == "rad"]


def reads_a_disc(effect: type[Effect]) -> bool:
    """Whether it is an error of the position's reading that comes round with a disc."""
    fields = effect.parameters()
    return effect.port == "sensing.displacement" and any(counts_periods(effect, f) for f in fields)


@cache
def shaping(effect: type[Effect], amplitude: str) -> tuple[str, ...]:
    """The shape numbers that matter where of the amplitudes only this one is not neutral.

    Asked of the kernel itself: the ratio of a ripple's second wave is nothing to the first wave.
    """
    shape = [f for f in effect.parameters() if f not in effect.neutral]
    if effect.state:
        return tuple(shape)
    return tuple(f for f in shape if _matters(effect, amplitude, f))


@cache
def waves(effect: type[Effect]) -> list[tuple[list[str], tuple[str, ...]]]:
    """Waves that an effect is made of: amplitudes, and the numbers whose product is their order."""
    if not any(counts_periods(effect, f) for f in effect.parameters() if f not in effect.neutral):
        return []
    found: dict[tuple[str, ...], list[str]] = {}
    for amplitude in effect.neutral:
        shape = shaping(effect, amplitude)  # type: ignore[arg-type] # a class is hashable
        found.setdefault(shape, []).append(amplitude)
    nominal = {f: about.nominal for f, about in effect.parameters().items()}
    alone = {s: {**nominal, **effect.neutral, a[0]: nominal[a[0]] or 1.0} for s, a in found.items()}
    return [
        (amplitudes, shape)
        for shape, amplitudes in found.items()
        if _repeats(effect, alone[shape], prod(nominal[f] for f in shape))
    ]


def _matters(effect: type[Effect], amplitude: str, field: str) -> bool:
    rng = np.random.default_rng(0)
    about = effect.parameters()
    for _ in range(DRAWS):
        drawn = {f: float(rng.uniform(p.low, p.high)) for f, p in about.items()}
        values = {**drawn, **effect.neutral, amplitude: drawn[amplitude]}
        signs = rng.choice([-1.0, 1.0], len(effect.reads) + 1)
        sizes = 10.0 ** rng.uniform(-3.0, 3.0, len(signs))
        told = [*effect.reads, *(["upstream"] if is_pipe(effect) else [])]
        values |= {a: float(s * z) for a, s, z in zip(told, signs, sizes, strict=False)}
        values |= {"dt": 1e-3} if "dt" in effect.arguments() else {}
        other = {**values, field: float(rng.uniform(about[field].low, about[field].high))}
        try:
            if effect.kernel(**values) != effect.kernel(**other):
                return True
        except (ArithmeticError, ValueError):  # not made for such numbers: nothing is known
            return True
    return False


def same_wave(model: Model, sizes: "Sizes") -> bool:
    """Whether two of a model's effects are waves of one order, as far as the stroke can tell.

    Each of several laws can ripple at the same order; two of them together fit the edges of any.
    """
    apart = _apart(sizes)
    orders = [
        model.fit.changes[f"{e.name()}.{f}"]
        for e in model.effects
        for f in e.parameters()
        if f not in e.neutral and counts_periods(e, f)
    ]
    return any(abs(one - two) < apart for one, two in combinations(orders, 2))


def repeated_waves(effects: Sequence[type[Effect]], fit: Fit, sizes: "Sizes") -> list[str]:
    """Numbers of waves of an effect that come at the order of another of its waves.

    Two waves that the stroke cannot tell apart are one wave.  Fitted as two, of opposite signs,
    they beat: a curve that fades in and out along the way, which no periodic law is.
    """
    found: list[str] = []
    for effect in effects:
        kept: dict[str, float] = {}  # numbers of the waves that stay -> order of one of them
        for amplitudes, shape in waves(effect):  # type: ignore[arg-type] # a class is hashable
            fitted = [f"{effect.name()}.{f}" for f in (*amplitudes, *shape)]
            if not all(name in fit.estimates for name in fitted):
                continue
            order = prod(fit.changes[name] for name in fitted[len(amplitudes) :])
            if any(abs(order - other) < _apart(sizes) for other in kept.values()):
                found += [name for name in fitted if name not in kept]
            else:
                kept |= dict.fromkeys(fitted, order)
    return found


def _apart(sizes: "Sizes") -> float:
    """By how much orders differ that the stroke tells apart: a period of it."""
    return float(2 * np.pi * sizes.angle / sizes.stroke)


def seldom_seen(model: Model) -> bool:
    """Whether a wave of the model ends as long as the bounds of its order let it.

    They let it come round twice on the way: two periods are needed to give its length.  What would
    be longer still comes round less, and is a curve of the place, as any other.
    """
    for effect in model.effects:
        names = {f: f"{effect.name()}.{f}" for f in effect.fitted() if f not in effect.neutral}
        told = {f: model.fit.estimates[n] for f, n in names.items() if n in model.fit.estimates}
        orders = [told[f] for f in told if counts_periods(effect, f)]
        slowest = any(o.at_bound and o.value - o.low < o.high - o.value for o in orders)
        if slowest and not reads_a_disc(effect):
            return True
    return False


def turned_round(model: Model) -> bool:
    """Whether waves that are shares of what they ripple together reach 1, or end at their bounds.

    An ampere whose torque turns round with the angle is no motor: other loads look so.
    """
    told = model.fit.estimates
    for effect in model.effects:
        about, whole = effect.parameters(), 0.0
        for amplitudes, _ in waves(effect):  # type: ignore[arg-type] # a class is hashable
            shares = [f"{effect.name()}.{f}" for f in amplitudes if about[f].unit == "1"]
            found = [told[name] for name in shares if name in told]
            whole += float(np.linalg.norm([one.value for one in found]))
            if whole >= 1.0 or any(one.at_bound for one in found):
                return True
    return False
