"""What only the whole model can show of an effect; the kernel's own laws are in `effects.check`."""

from collections.abc import Iterator, Mapping
from functools import cache

import numba
import numpy as np
import scipy
from numba.core.errors import NumbaError

from spirob.can_protocol import AMPERE_PER_COUNT
from spirob.control import CURRENT, VELOCITY, Schedule
from spirob.effects import Effect, replay
from spirob.effects.check import Finding
from spirob.effects.replay import run
from spirob.errors import SimulationError
from spirob.plant.plant import Plant, Response
from spirob.plant.rig import Rig
from spirob.ports import PORTS
from spirob.robot import Scene

READINGS = {"current": AMPERE_PER_COUNT, "displacement": 1e-6}  # resolution [A, m]
CYCLES = 1000
STARVED = {"drive.voltage_limit": 2.0}  # V: the drive meets its limit at the strokes' speed


def check_in_model(effect: type[Effect], plant: Plant | None = None) -> list[Finding]:
    """Laws that this effect breaks inside the coupled model; empty for a sound effect.

    plant  a model that holds the effect among others; without one, one is made and compiled
    """
    try:
        out = [Finding("compiled", sentence) for sentence in compiled(effect)]
        plant = plant or Plant(Rig(), [effect])
    except NumbaError as wrong:
        return [Finding("compiled", f"it cannot be compiled: {str(wrong).splitlines()[0]}")]
    for law in IN_MODEL:
        try:
            out += [Finding(law.__name__, sentence) for sentence in law(effect, plant)]
        except SimulationError as wrong:
            out.append(Finding(law.__name__, str(wrong)))
        if out:
            return (
                out  # what does not run has no strength to be seen, what is not seen none to find
            )
    return out


def compiled(effect: type[Effect]) -> Iterator[str]:
    """The compiled kernel gives what the Python kernel gives."""
    if PORTS[effect.port].every == "once":
        return  # never compiled
    rng = np.random.default_rng(1)
    numbers = replay.typical(effect, rng)
    inputs = replay.motion(effect, rng, 100, 1e-3)
    fast = type("Compiled", (), {})
    for name in ("arguments", "state"):
        setattr(fast, name, getattr(effect, name))
    fast.kernel = staticmethod(numba.njit(effect.kernel))  # type: ignore[attr-defined]
    got, _ = run(fast, numbers, inputs, 1e-3)  # type: ignore[arg-type]
    want, _ = run(effect, numbers, inputs, 1e-3)
    if not np.allclose(got, want, rtol=1e-12, atol=1e-12 * np.abs(want).max()):
        yield f"compiled and interpreted differ by {np.abs(got - want).max():.3g}"


def nested(effect: type[Effect], plant: Plant) -> Iterator[str]:
    """At its neutral numbers the model with the effect gives the bits of the model without."""
    neutral = {f"{effect.name()}.{n}": v for n, v in effect.neutral.items()}
    without, held = _bare(), plant.simulate(*_trials()["strokes"], neutral)
    for reading in (*READINGS, "tension", "angles"):
        if not np.array_equal(getattr(held, reading), getattr(without, reading)):
            yield f"'{reading}' differs from the model without it"


def seen(effect: type[Effect], plant: Plant) -> Iterator[str]:
    """At its nominal numbers a reading changes by more than its resolution in some trial."""
    if max(_changes(effect, plant).values()) < 1.0:
        yield "the arm does not show it: no reading changes by its resolution at nominal numbers"


def found(effect: type[Effect], plant: Plant) -> Iterator[str]:
    """Its strength is found again by fitting the model to the model, from half of it."""
    changes = _changes(effect, plant)
    trial = max(changes, key=changes.__getitem__)
    want = _readings(_play(effect, plant, trial, 1.0))
    size = np.abs(want - _readings(_play(effect, plant, trial, 0.0))).max()

    def miss(strength: float) -> float:
        got = _readings(_play(effect, plant, trial, strength))
        return float(np.mean(((got - want) / size) ** 2))

    search = {"bounds": (0.5, 1.3), "method": "bounded", "options": {"xatol": 1e-3}}
    best = scipy.optimize.minimize_scalar(miss, **search).x
    if abs(best - 1.0) > 0.01:
        yield f"in trial '{trial}' its strength is found as {best:.3f} of the true one"


IN_MODEL = (nested, seen, found)
LAWS = {law.__name__: law for law in (compiled, *IN_MODEL)}


def _changes(effect: type[Effect], plant: Plant) -> dict[str, float]:
    # the largest change of a reading in units of its resolution, by trial
    out = {}
    for trial in _trials():
        without, held = (_readings(_play(effect, plant, trial, s)) for s in (0.0, 1.0))
        out[trial] = float(np.abs(held - without).max())
    return out


def _play(effect: type[Effect], plant: Plant, trial: str, strength: float) -> Response:
    changes = dict(STARVED if trial == "starved" else {})
    for name, about in effect.parameters().items():
        value = about.nominal
        if name in effect.neutral:
            value = effect.neutral[name] + strength * (value - effect.neutral[name])
        changes[f"{effect.name()}.{name}"] = value
    return plant.simulate(*_trials()[trial], changes)


def _readings(response: Response) -> np.ndarray:
    return np.stack([getattr(response, r) / size for r, size in READINGS.items()])


@cache
def _bare() -> Response:
    return Plant(Rig()).simulate(*_trials()["strokes"])


@cache
def _trials() -> Mapping[str, tuple[Schedule, Scene]]:
    # strokes with reversals; both tendons pulling against each other; strokes at a weak supply
    time = np.arange(CYCLES) * 1e-3
    speed = 0.12 * np.sin(2 * np.pi * time / 0.5)
    pull = 0.8 + 0.3 * np.sin(2 * np.pi * time / 0.7)
    strokes = _schedule(VELOCITY, speed, -speed)
    squeeze = _schedule(CURRENT, pull, 1.4 - 0.8 * pull)
    return {"strokes": (strokes, Scene()), "squeeze": (squeeze, Scene())} | {
        "starved": (strokes, Scene())
    }


def _schedule(mode: int, left: np.ndarray, right: np.ndarray) -> Schedule:
    reference = np.column_stack([left, right])
    return Schedule(np.array([mode, mode]), reference, np.zeros_like(reference), np.full(2, 5.0))
