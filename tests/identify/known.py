"""Trials made by the model itself, with known numbers: what a fit must find again."""

from collections.abc import Mapping

from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual
from spirob.plant import Plant, Rig
from spirob.trials import Trial
from spirob.trials.simulation import simulate


def moves(motor: str, waypoints: list, hold: float) -> dict:
    """A trial of smooth moves of one motor against a constant current of the other."""
    other = "right" if motor == "left" else "left"
    return {
        "duration": 4.0,
        "motors": {
            motor: {
                "mode": "displacement",
                "current_limit": 5.0,
                "profile": {"kind": "moves", "waypoints": waypoints},
            },
            other: {
                "mode": "current",
                "current_limit": 5.0,
                "profile": {"kind": "constant", "value": hold, "blend": 0.3},
            },
        },
    }


# slow enough that a geared antagonist, kilograms seen at its tendon, follows without going slack
TRIALS = {
    "train": [
        moves("left", [[0.3, 0.0], [1.8, 0.05], [0.3, 0.05], [1.5, 0.02]], 0.25),
        moves("right", [[0.3, 0.0], [2.0, 0.06], [1.5, 0.03]], 0.3),
    ],
    "validate": [moves("left", [[0.3, 0.0], [2.0, 0.06], [1.6, 0.03]], 0.3)],
    "heldout": [moves("right", [[0.3, 0.0], [1.7, 0.05], [0.4, 0.05], [1.5, 0.03]], 0.25)],
}
NOISE = 0.005  # A


def residual(
    plant: Plant, true: Mapping[str, float], role: str = "train", seed: int = 0
) -> Residual:
    """The residual of `plant` on trials that it played itself with the numbers `true`."""
    measured = []
    for k, plain in enumerate(TRIALS[role]):
        trial = Trial.from_plain({"name": f"{role}_{k}", "role": role, **plain})
        trace = simulate(plant, trial, true, NOISE, seed=100 * seed + k)
        measured.append(Measurement.from_trace(trace))
    return Residual(plant, measured)


def spirob(effects: list | None = None) -> Plant:
    """The default machine with effects."""
    return Plant(Rig(), effects or [])
