"""Does an effect keep what it declares?  The laws that every effect is held to.

Each law is a function from an effect to sentences, empty when the law holds; `check` runs them all.
What only the whole model can show (the effect is seen, it stays finite) is in `plant.check`.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np
import scipy

from spirob.effects import all_effects, replay
from spirob.effects.effect import Effect, evaluate
from spirob.effects.replay import run
from spirob.errors import EffectError
from spirob.ports import PORTS, SIGNALS
from spirob.units import BASE, rescaled

STEPS = (2.5e-4, 5e-4, 1e-3)  # s, of the physics and of the bus
EXACT = 1e-9
ROUNDING = 1e-9  # change of a state below which its last bits count
SAMPLES = 400


@dataclass(frozen=True)
class Finding:
    """A law that the effect breaks, and how."""

    law: str
    sentence: str


def check(effect: type[Effect]) -> list[Finding]:
    """Every law that this effect breaks; empty for a sound effect."""
    out = []
    for law, test in LAWS.items():
        try:
            out += [Finding(law, sentence) for sentence in test(effect)]
        except (ArithmeticError, ValueError, TypeError, NameError, EffectError) as wrong:
            out.append(Finding(law, f"{type(wrong).__name__}: {wrong}"))
    return out


def texts(effect: type[Effect]) -> Iterator[str]:
    """A reader finds every text, and every rival exists."""
    for field in ("title", "signature", "explanation", "needs"):
        if not getattr(effect, field).strip():
            yield f"'{field}' is empty"
    for field in ("signature", "explanation"):
        if not getattr(effect, field).rstrip().endswith("."):
            yield f"'{field}' is not a sentence: it ends without a full stop"
    if not effect.references:
        yield "'references' is empty: where does the law come from?"
    if not effect.tell_apart:
        yield "'tell_apart' is empty: name the effect that looks most like it"
    if not effect.kernel.__doc__:
        yield "the kernel has no docstring: what does it return, in which unit?"
    for rival, experiment in effect.tell_apart.items():
        if rival not in all_effects() or rival == effect.name():
            yield f"rival '{rival}' does not exist; known: {', '.join(all_effects())}"
        if not experiment.strip():
            yield f"rival '{rival}' has no experiment that separates the two"


def equation(effect: type[Effect]) -> Iterator[str]:
    """The kernel computes what the equation says."""
    if not effect.equation:
        if not effect.state:
            yield "no equation, and no state that would excuse it"
        return
    rng = _rng(effect)
    for _ in range(20):
        numbers = replay.drawn(effect, rng)
        inputs = replay.points(effect, rng, 20)
        got, trail = run(effect, numbers, inputs, 1e-3)
        want = evaluate(effect, effect.equation, numbers, {**inputs, **trail})
        if not np.allclose(got, want, rtol=EXACT, atol=1e-12 * (1.0 + np.abs(want).max())):
            k = int(np.argmax(np.abs(got - want)))
            at = {a: float(v[k]) for a, v in inputs.items()} | numbers
            yield f"the kernel gives {got[k]:.6g}, the equation {want[k]:.6g} at {at}"
            return


def evolution(effect: type[Effect]) -> Iterator[str]:
    """A state follows its declared law, and one step is as good as two half ones."""
    rng = _rng(effect)
    for state, law in effect.evolution.items():
        for _ in range(20):
            numbers = replay.typical(effect, rng)
            inputs = replay.motion(effect, rng, 50, 1e-3)
            _, trail = run(effect, numbers, inputs, 1e-3)
            now = {s: float(v[-1]) for s, v in trail.items()}
            last = {a: v[-1:] for a, v in inputs.items()}
            want = evaluate(effect, law, numbers, {**last, **now}).item()
            tiny = 1e-8
            got = (run(effect, numbers, last, tiny, now)[1][state][0] - now[state]) / tiny
            if abs(got - want) > 1e-3 * abs(want) + 1e-6 * (1.0 + abs(now[state])) / 1e-3:
                yield f"'{state}' changes at {got:.6g}/s, its law says {want:.6g}/s"
                return
            if (gap := _halving(effect, numbers, last, now)) > 1e-6:
                yield f"two half steps differ from one whole step by {gap:.1e} of its change"
                return


def _halving(effect, numbers, last, now) -> float:
    dt = 1e-3
    half = {a: np.repeat(v, 2) for a, v in last.items()}
    speed, position = replay.speed_argument(effect), replay.position_argument(effect)
    if speed is not None and position is not None:
        half[position][0] -= half[speed][0] * dt / 2
    whole = run(effect, numbers, last, dt, now)[1]
    twice = run(effect, numbers, half, dt / 2, now)[1]
    change = max(abs(whole[s][-1] - now[s]) for s in effect.state)
    return float(max(abs(whole[s][-1] - twice[s][-1]) for s in effect.state) / (change + ROUNDING))


def neutral(effect: type[Effect]) -> Iterator[str]:
    """At its neutral numbers the effect is absent to the last bit."""
    rng = _rng(effect)
    for _ in range(20):
        numbers = {**replay.drawn(effect, rng), **effect.neutral}
        inputs = replay.motion(effect, rng, 50, 1e-3)
        got, _ = run(effect, numbers, inputs, 1e-3)
        if not np.array_equal(got, _absent(inputs, got)):
            yield f"at {numbers} it still does {np.abs(got - _absent(inputs, got)).max():.3g}"
            return


def finite(effect: type[Effect]) -> Iterator[str]:
    """Finite in the whole box of its numbers, at standstill and at the ends of every signal."""
    rng = _rng(effect)
    boxes = [*replay.corners(effect, rng), *(replay.drawn(effect, rng) for _ in range(20))]
    for numbers in boxes:
        for dt in STEPS:
            inputs = replay.extremes(effect, rng, SAMPLES // 4)
            got, trail = run(effect, numbers, inputs, dt)
            if not all(np.isfinite(v).all() for v in (got, *trail.values())):
                k = int(np.argmin(np.isfinite(got)))
                at = {a: float(v[k]) for a, v in inputs.items()}
                yield f"not finite at {numbers}, {at}, dt = {dt}"
                return


def bounded(effect: type[Effect]) -> Iterator[str]:
    """A state does not run away, however long a trial lasts and however coarse its step."""
    rng = _rng(effect)
    for numbers in islice(replay.corners(effect, rng), 16) if effect.state else ():
        inputs = replay.extremes(effect, rng, 4000)
        _, trail = run(effect, numbers, inputs, 1.0)
        for state, values in trail.items():
            early, late = np.abs(values[:2000]).max(), np.abs(values[2000:]).max()
            if not late <= 2.0 * early + 1e-12:
                yield f"state '{state}' grows from {early:.3g} to {late:.3g} at {numbers}"
                return


def units(effect: type[Effect]) -> Iterator[str]:
    """The kernel does not care in which units it is asked.

    Metre, kilogram, second, ampere ... are each measured in another unit; what the kernel returns
    must change as the port's unit does.  A constant with a unit hidden in the kernel breaks this.
    """
    rng = _rng(effect)
    sizes = {base: 2.0 ** (k + 1) for k, base in enumerate(BASE)}  # exact in binary
    unit_of = {a: SIGNALS[s].unit for a, s in effect.reads.items()}
    unit_of["upstream"] = PORTS[effect.port].unit
    scale = {a: rescaled(u, sizes) for a, u in unit_of.items()}
    numbers = replay.typical(effect, rng)
    about = effect.parameters()
    other = {n: v * rescaled(about[n].unit, sizes) for n, v in numbers.items()}
    inputs = replay.motion(effect, rng, 50, 1e-3)
    got, _ = run(effect, other, {a: v * scale[a] for a, v in inputs.items()}, 1e-3 * sizes["s"])
    want = run(effect, numbers, inputs, 1e-3)[0] * scale["upstream"]
    size = np.abs(want).max()
    if not (np.isfinite(size) and np.allclose(got, want, rtol=EXACT, atol=EXACT * size)):
        yield f"its numbers and signals do not combine to {unit_of['upstream']} of {effect.port}"


def traits(effect: type[Effect]) -> Iterator[str]:
    """What it claims of itself is true."""
    for trait in sorted(effect.traits):
        rng = _rng(effect)
        for _ in range(20):
            if sentence := TRAIT_LAWS[trait](effect, rng):
                yield f"it is not {trait}: {sentence}"
                break


def recovery(effect: type[Effect]) -> Iterator[str]:
    """Its strength is found again from what it did, under one per cent of noise."""
    rng = _rng(effect)
    numbers = replay.typical(effect, rng)
    inputs = replay.motion(effect, rng, SAMPLES, 1e-3)
    dt = 1e-3
    names = list(effect.neutral)
    about = effect.parameters()
    unit = np.array([replay.amplitude(effect, n) for n in names])
    true = np.array([numbers[n] for n in names])
    clean, _ = run(effect, numbers, inputs, dt)
    rms = float(np.sqrt(np.mean((clean - _absent(inputs, clean)) ** 2)))
    seen = clean + rng.normal(0.0, 1e-2 * rms, clean.shape)

    def miss(share: np.ndarray) -> np.ndarray:
        tried = {**numbers, **dict(zip(names, (share * unit).tolist(), strict=True))}
        return (run(effect, tried, inputs, dt)[0] - seen) / (rms + 1e-300)

    low = np.array([about[n].low for n in names]) / unit
    high = np.array([about[n].high for n in names]) / unit
    bounds = (np.minimum(low, high), np.maximum(low, high))
    found = scipy.optimize.least_squares(miss, np.clip(0.8, *bounds), bounds=bounds).x * unit
    for name, got, want, nominal in zip(names, found, true, unit, strict=True):
        if abs(got - want) > 0.05 * abs(nominal):
            yield f"'{name}' was {want:.4g} and is found as {got:.4g}"


def _dissipative(effect: type[Effect], rng: np.random.Generator) -> str:
    speed = replay.speed_argument(effect)
    if speed is None:
        return "it reads no speed"
    numbers = replay.drawn(effect, rng)
    moving = replay.motion(effect, rng, SAMPLES, 1e-3, periods=3)
    inputs = replay.steady(effect, moving, rng)
    got, _ = run(effect, numbers, inputs, 1e-3)
    power = (got - _absent(inputs, got)) * inputs[speed]
    # what has a memory may give back what it stored, but nothing over a closed path
    work = power[-SAMPLES:].sum() if effect.state else power.max()
    return f"it does work, {work:.3g}" if work > 1e-9 * np.abs(power).sum() else ""


def _parity(sign: float) -> Callable[[type[Effect], np.random.Generator], str]:
    def law(effect: type[Effect], rng: np.random.Generator) -> str:
        speed, position = replay.speed_argument(effect), replay.position_argument(effect)
        numbers = replay.drawn(effect, rng)
        inputs = replay.motion(effect, rng, 100, 1e-3)
        turned = {a: -v if a in (speed, position) else v for a, v in inputs.items()}
        ahead, back = (run(effect, numbers, i, 1e-3)[0] for i in (inputs, turned))
        ahead, back = ahead - _absent(inputs, ahead), back - _absent(turned, back)
        gap = np.abs(back - sign * ahead).max()
        if gap <= EXACT:
            return ""
        return f"turning the motion round, speed and position, misses by {gap:.3g}"

    return law


def _rate_independent(effect: type[Effect], rng: np.random.Generator) -> str:
    numbers = replay.drawn(effect, rng)
    inputs = replay.motion(effect, rng, 100, 1e-3)
    faster = {a: v * 4.0 if effect.reads.get(a) in replay.RATES else v for a, v in inputs.items()}
    slow, fast = run(effect, numbers, inputs, 1e-3)[0], run(effect, numbers, faster, 2.5e-4)[0]
    gap = np.abs(fast - slow).max()
    size = np.abs(slow).max() + 1e-300
    if gap <= EXACT * size:
        return ""
    share = f"{gap / size:.2g} of its size"
    return f"four times faster it differs by {gap:.3g} {PORTS[effect.port].unit}, {share}"


def _constant(effect: type[Effect], rng: np.random.Generator) -> str:
    numbers = replay.drawn(effect, rng)
    one, other = (replay.motion(effect, rng, 50, 1e-3) for _ in range(2))
    for argument, signal in effect.reads.items():
        if SIGNALS[signal].given:
            other[argument] = one[argument]
    first, second = (run(effect, numbers, i, 1e-3)[0] for i in (one, other))
    first, second = first - _absent(one, first), second - _absent(other, second)
    gap = float(np.ptp(np.concatenate([first, second])))
    return f"it varies by {gap:.3g}" if gap > EXACT * (1.0 + np.abs(first).max()) else ""


TRAIT_LAWS: dict[str, Callable[[type[Effect], np.random.Generator], str]] = {
    "dissipative": _dissipative,
    "odd_in_speed": _parity(-1.0),
    "even_in_speed": _parity(1.0),
    "rate_independent": _rate_independent,
    "constant": _constant,
}
LAWS: dict[str, Callable[[type[Effect]], Iterator[str]]] = {
    law.__name__: law
    for law in (
        texts,
        equation,
        evolution,
        neutral,
        finite,
        bounded,
        units,
        traits,
        recovery,
    )
}


def _absent(inputs: replay.Inputs, like: np.ndarray) -> np.ndarray:
    # what the port would carry without the effect
    return inputs.get("upstream", np.zeros_like(like))


def _rng(effect: type[Effect]) -> np.random.Generator:
    return np.random.default_rng(list(effect.name().encode()))
