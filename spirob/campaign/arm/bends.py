"""A robot with something hidden plays eight bends over the bus; its logs are decoded.

Each bend takes three seconds.  Slow and fast, shallow and deep, up and down, with holds, on either
side and against four tensions of the antagonist; the antagonist's current is high enough that its
tendon stays taut.  The trials that decide load the right motor, as hardly any that is fitted does:
what a model says of a load that it was not fitted to tells a law from its imitation.
"""

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from spirob.diagnosis.proposals import bend
from spirob.diagnosis.simulated import ROLES
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.emulator.robot import EmulatedRobot
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual
from spirob.logs import read_log
from spirob.plant import Plant, Rig
from spirob.trials import Trial, record

# name, role, motor that moves, (duration [s], length [m]) of its moves, current of the other [A];
# a trial lasts as long as its moves
BENDS = (
    ("train_deep", "train", "left", ((0.1, 0.0), (1.9, 0.045), (0.8, 0.034)), 0.6),
    (
        "train_fast",
        "train",
        "right",
        ((0.1, 0.0), (0.7, 0.01), (0.6, 0.003), (0.7, 0.012), (0.6, 0.005)),
        1.2,
    ),
    (
        "train_slow",
        "train",
        "left",
        ((0.1, 0.0), (1.0, 0.014), (0.2, 0.014), (0.8, 0.006), (0.6, 0.01)),
        0.5,
    ),
    ("train_far", "train", "right", ((0.1, 0.0), (2.0, 0.055), (0.7, 0.046)), 0.65),
    (
        "validate_left",
        "validate",
        "left",
        ((0.1, 0.0), (1.1, 0.025), (0.2, 0.025), (0.7, 0.015), (0.7, 0.021)),
        1.1,
    ),
    (
        "validate_right",
        "validate",
        "right",
        ((0.1, 0.0), (1.9, 0.048), (0.2, 0.048), (0.6, 0.04)),
        0.6,
    ),
    (
        "heldout_left",
        "heldout",
        "left",
        ((0.1, 0.0), (1.7, 0.04), (0.2, 0.04), (0.8, 0.028)),
        0.6,
    ),
    (
        "heldout_right",
        "heldout",
        "right",
        ((0.1, 0.0), (0.9, 0.016), (0.2, 0.016), (0.7, 0.007), (0.9, 0.02)),
        1.3,
    ),
)


def bends() -> list[dict[str, Any]]:
    """The trials as plain data for `Trial.from_plain`."""
    return [
        bend(name, role, motor, moves, {"kind": "constant", "value": current})
        for name, role, motor, moves, current in BENDS
    ]


def recorded(
    hidden: HiddenSettings, seed: int, trials: Sequence[Mapping[str, Any]] | None = None
) -> dict[str, list[Measurement]]:
    """Play trials over the bus, the bends where none are given, and decode their logs."""
    rig = Rig()
    machine = EmulatedRig(
        gear_ratio=rig.winch.gear_ratio,
        winch_radius=rig.winch.radius,
        gravity=(rig.arm.gravity_x, rig.arm.gravity_y),
        current_bandwidth=rig.drive.bandwidth,
    )
    robot = EmulatedRobot(machine, hidden, seed)
    found: dict[str, list[Measurement]] = {role: [] for role in ROLES}
    try:
        with tempfile.TemporaryDirectory(prefix="spirob-trial-") as folder:
            for plain in bends() if trials is None else trials:
                path = Path(folder) / f"{plain['name']}.mcap"
                record(Trial.from_plain(plain), robot, path, rig)
                found[plain["role"]].append(Measurement.from_trace(read_log(path)))
    finally:
        robot.close()
    return found


def problems_of(trials: dict[str, list[Measurement]], plant: Plant) -> dict[str, Residual]:
    """What the fit, the search's decision and the final figure compare."""
    return {role: Residual(plant, of, workers=1) for role, of in trials.items()}
