"""The regimes of the atlas: which samples belong to each, by what they are about.

The regimes of one kind take a stretch apart (slow, middle, fast; first, middle, last third);
regimes of different kinds overlap.  A kind whose signal was not recorded is left out.
"""

import numpy as np

from spirob.identify.problem import Stretch

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
    least = STEADY * float(np.sqrt(np.mean(load**2)))
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
