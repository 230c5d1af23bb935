"""The residual atlas: which regimes hold the error, of the drives and of the arm.

Every sample of the residual is put into overlapping regimes, and, of several trials,
into its own; each regime gets its share of the squared error beside its share of the time, and its
bias.

The regimes of one kind take a stretch apart (slow, middle, fast; first, middle, last third);
regimes of different kinds overlap.  A kind whose signal was not recorded is left out.  A slack
tendon, the end stop and an object near by are regimes that drives do not see: the model that is
judged says when, by its tendons' tension and its hinges' angles.

Lateness is that of the measurement, or of the axis behind its command.  A measurement that trails
the model by τ leaves, model minus measurement, i(t) - i(t - τ) ≈ τ di/dt; so τ and its share of the
squared error follow from a regression on the measured rate.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from spirob.diagnosis.flexible import dependence, told
from spirob.diagnosis.spectrum import orders
from spirob.identify.problem import Effort, Problem, Stretch, rms
from spirob.identify.residual import Residual

REVERSAL = 0.1  # s, on either side of a change of direction
AROUND = 0.05  # s, on either side: over this the load is compared with itself
STEADY = 0.02  # of the load's RMS: what changes by less is steady
BAND = 5.0  # °C, of a winding's temperature

Masks = dict[str, np.ndarray]  # regime -> (N,) whether a sample belongs to it


def masks_of(piece: Stretch) -> Masks:
    """Which samples of a stretch belong to each regime."""
    return {name: mask for masks in kinds_of(piece).values() for name, mask in masks.items()}


def kinds_of(piece: Stretch) -> dict[str, Masks]:
    """The same by kind: what a regime is about."""
    middle = piece.seconds[0] + 0.5 * (piece.seconds[-1] - piece.seconds[0])
    kinds = {
        "velocity": _velocity(piece),
        "reversal": {"0.1 s around reversals": _near_reversals(piece)},
        "load": _thirds(piece.effort, "low load", "middle load", "high load"),
        "loading": _loading(piece),
        "way": _thirds(
            np.abs(piece.position),
            "nearest third of the way",
            "middle third of the way",
            "furthest third of the way",
        ),
        "time": {"second half of the trial": piece.seconds >= middle, **_time(piece)},
    }
    if piece.lag is not None:
        kinds["command lag"] = _thirds(
            np.abs(piece.lag), "least third of lag", "middle third of lag", "largest third of lag"
        )
    if piece.temperature is not None:
        kinds["temperature"] = _bands(piece.temperature)
    if piece.channel:
        kinds["motor"] = {f"{piece.channel} driven": np.ones(len(piece.velocity), dtype=bool)}
    return kinds


def _velocity(piece: Stretch) -> Masks:
    """Both directions, standing, and each direction in thirds of the moving samples' speed."""
    velocity, speed = piece.velocity, np.abs(piece.velocity)
    moving = speed > piece.still
    found = {
        piece.forward: velocity > piece.still,
        piece.backward: velocity < -piece.still,
        "standing": ~moving,
        "fastest third": speed >= np.quantile(speed, 0.67),
    }
    low, high = np.quantile(speed[moving], [0.33, 0.67]) if moving.any() else (0.0, 0.0)
    bands = {
        "slow": speed < low,
        "at middle speed": (speed >= low) & (speed < high),
        "fast": speed >= high,
    }
    for way in (piece.forward, piece.backward):
        found |= {f"{way}, {name}": found[way] & band for name, band in bands.items()}
    return found


def _near_reversals(piece: Stretch) -> np.ndarray:
    turns = piece.seconds[:-1][np.diff(np.sign(piece.velocity)) != 0]
    ended = np.searchsorted(turns, piece.seconds - REVERSAL)
    return np.asarray(np.searchsorted(turns, piece.seconds + REVERSAL, "right") > ended)


def _loading(piece: Stretch) -> Masks:
    """Whether the load's size grows or falls over the tenth of a second around a sample."""
    load = np.abs(piece.effort)
    after = np.interp(piece.seconds + AROUND, piece.seconds, load)
    change = after - np.interp(piece.seconds - AROUND, piece.seconds, load)
    least = STEADY * rms(load)
    rises, falls = change > least, change < -least
    return {"loading": rises, "unloading": falls, "steady load": ~rises & ~falls}


def _time(piece: Stretch) -> Masks:
    """Thirds of the time since the stretch began."""
    begin, end = piece.seconds[0], piece.seconds[-1]
    third = np.minimum(3 * (piece.seconds - begin) / max(end - begin, 1e-12), 2.0).astype(int)
    return {
        f"{n} third of the trial": third == k for k, n in enumerate(("first", "middle", "last"))
    }


def _thirds(values: np.ndarray, low: str, middle: str, high: str) -> Masks:
    below, above = values <= np.quantile(values, 0.33), values >= np.quantile(values, 0.67)
    return {low: below, middle: ~below & ~above, high: above}


def _bands(temperature: np.ndarray) -> Masks:
    """Bands of a temperature, the coolest first; the same edges in every trial."""
    band = np.floor(temperature / BAND).astype(int)
    return {
        f"winding at {BAND * k:.0f} to {BAND * (k + 1):.0f} °C": band == k for k in np.unique(band)
    }


WHOLE = 0.8  # of the time: a regime that takes more is no place of its own
ALONE = ("temperature", "trial", "slack", "contact")  # one regime in all of the time tells nothing
# kinds that say much the same: of these one sentence is enough
FAMILIES = {"trial": "motor", "loading": "load"}


@dataclass(frozen=True)
class Regime:
    """One region of the data.

    share_of_error  of the summed squared residual;  share_of_time  of the samples
    bias, rmse      of the residual inside, in its unit
    kind            what it is about: regimes of one kind are compared with one another
    """

    regime: str
    share_of_error: float
    share_of_time: float
    bias: float
    rmse: float
    kind: str = ""


def atlas(
    residual: Problem, values: np.ndarray, more: Sequence[dict[str, Masks]] = ()
) -> list[Regime]:
    """Regimes of a residual (as `residual` returned it), the largest share of error first.

    more  of each stretch: kind -> masks that do not follow from its own signals
    """
    pieces = residual.stretches()
    known = [kinds_of(p) | {"trial": {p.trial: np.ones(len(p.seconds), bool)}} for p in pieces]
    for k, further in enumerate(more):
        known[k] |= further
    total = float(np.sum(values**2)) or 1.0
    regimes = []
    names = dict.fromkeys((kind, n) for found in known for kind in found for n in found[kind])
    for kind, name in names:
        # a regime that another stretch does not know holds nothing of that stretch
        parts = [
            found.get(kind, {}).get(name, np.zeros(len(p.velocity), bool))
            for found, p in zip(known, pieces, strict=True)
        ]
        inside = values[np.concatenate(parts)]
        if len(inside) == 0 or (kind in ALONE and len(inside) == len(values)):
            continue
        share = float(np.sum(inside**2)) / total
        rmse = rms(inside)
        time = len(inside) / len(values)
        regimes.append(Regime(name, share, time, float(np.mean(inside)), rmse, kind))
    return sorted(regimes, key=lambda r: -r.share_of_error)


def worst(regimes: Sequence[Regime], effort: Effort, count: int = 3) -> list[str]:
    """The regimes that hold more error than their time explains, a sentence each.

    Of the regimes of one kind, which overlap or follow from one another, the worst alone.
    """
    dense: dict[str, Regime] = {}
    for regime in sorted(regimes, key=lambda r: r.share_of_time - r.share_of_error):
        if regime.share_of_error > regime.share_of_time and regime.share_of_time <= WHOLE:
            dense.setdefault(FAMILIES.get(regime.kind, regime.kind) or regime.regime, regime)
    return [
        f"{r.share_of_error:.0%} of the error in {r.share_of_time:.0%} of the time: {r.regime} "
        f"(model minus measurement {effort.shown(r.bias)} on average)."
        for r in list(dense.values())[:count]
    ]


SLACK = 0.05  # N: a tendon that pulls less moves nothing
CLOSED = 0.99  # of the end stop's angle: neighbouring units touch


def situations(residual: Residual, changes: Mapping[str, float]) -> list[dict[str, Masks]]:
    """Of each stretch of the residual: kind -> regime -> (N,) whether a sample belongs to it.

    changes  numbers of the model that says where the arm is
    """
    found = []
    limit = residual.plant.rig.arm.limit_ratio * residual.plant.geometry.hinge_angle
    for k, trial in enumerate(residual.trials):
        response = residual.respond(changes, k)
        cycles = residual.cycles(trial)
        slack = response.tension[cycles] < SLACK
        closed = (np.abs(response.angles[cycles]) > CLOSED * limit).any(axis=1)
        for motor in residual.driven(trial):
            contact = {"curled to the end stop": closed}
            if trial.scene.touchable:
                contact["an object within reach"] = np.ones(len(closed), dtype=bool)
            pulls = {
                "pulling tendon slack": slack[:, motor],
                "antagonist slack": np.delete(slack, motor, axis=1).any(axis=1),
            }
            found.append({"slack": pulls, "contact": contact})
    return found


def lateness(pieces: Sequence[Stretch], values: np.ndarray) -> dict[str, Any]:
    """What a delay and what the command's rate explain of a residual (N,).

    delay_ms       by which the measurement trails the model [ms], negative where it is ahead
    delay_share    of the squared residual that this delay explains
    command_share  of it that follows the rate of the command; None where no command was recorded
    """
    slopes = np.concatenate([_slope(p.effort, p.seconds) for p in pieces])
    delay, share = _regressed(values, slopes)
    commands = [p.command_rate for p in pieces if p.command_rate is not None]
    known = len(commands) == len(pieces)
    return {
        "delay_ms": 1e3 * delay,
        "delay_share": share,
        "command_share": _regressed(values, np.concatenate(commands))[1] if known else None,
    }


def _slope(values: np.ndarray, seconds: np.ndarray) -> np.ndarray:
    return np.asarray(np.gradient(values, seconds)) if len(values) > 1 else np.zeros(len(values))


def _regressed(values: np.ndarray, on: np.ndarray) -> tuple[float, float]:
    """Slope of the regression without a constant, and the share of Σ values² that it explains."""
    power, both = float(on @ on), float(values @ on)
    if power == 0.0:
        return 0.0, 0.0
    return both / power, both**2 / (power * (float(values @ values) or 1.0))


KEYS = ("atlas", "atlas_sentences", "atlas_orders", "atlas_lateness", "depends")


def survey(residual: Residual, changes: Mapping[str, float], values: np.ndarray) -> dict[str, Any]:
    """What the diagnosis says of the base model's residual; its keys are `KEYS`.

    changes  numbers of the base model;  values  what it leaves of the effort alone, (N,)
    """
    regimes = atlas(residual, values, situations(residual, changes))
    pieces = residual.stretches()
    waves = orders(pieces, values)
    alone = dependence(residual, values)
    return {
        "atlas": [asdict(r) for r in regimes],
        "atlas_sentences": worst(regimes, residual.effort),
        "atlas_orders": [asdict(w) for w in waves],
        "atlas_lateness": lateness(pieces, values),
        "depends": {"sentence": told(alone, waves), "alone": alone},
    }
