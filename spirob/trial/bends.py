"""The short experiment that every robot of the trial plays: eight bends of four seconds.

Slow and fast, shallow and deep, up and down, with holds, on either side and against four tensions
of the antagonist; the antagonist's current is high enough that its tendon stays taut.
"""

from typing import Any

DURATION = 4.0  # s

# name, role, motor that moves, (duration [s], length [m]) of its moves, current of the other [A]
BENDS = (
    (
        "train_left",
        "train",
        "left",
        ((0.2, 0.0), (1.6, 0.05), (0.4, 0.05), (1.4, 0.015), (0.4, 0.015)),
        0.4,
    ),
    ("train_deep", "train", "right", ((0.2, 0.0), (2.0, 0.08), (0.4, 0.08), (1.4, 0.05)), 0.35),
    (
        "train_fast",
        "train",
        "left",
        ((0.2, 0.0), (0.9, 0.025), (0.9, 0.005), (1.0, 0.03), (0.8, 0.012), (0.2, 0.012)),
        0.6,
    ),
    (
        "train_right",
        "train",
        "right",
        ((0.2, 0.0), (1.2, 0.035), (0.5, 0.035), (1.2, 0.06), (0.9, 0.045)),
        0.25,
    ),
    (
        "validate_left",
        "validate",
        "left",
        ((0.2, 0.0), (1.8, 0.065), (0.3, 0.065), (1.5, 0.03), (0.2, 0.03)),
        0.45,
    ),
    (
        "validate_right",
        "validate",
        "right",
        ((0.2, 0.0), (1.1, 0.03), (0.3, 0.03), (1.0, 0.01), (1.4, 0.05)),
        0.5,
    ),
    (
        "heldout_left",
        "heldout",
        "left",
        ((0.2, 0.0), (1.3, 0.04), (0.4, 0.04), (1.0, 0.02), (1.1, 0.045)),
        0.5,
    ),
    (
        "heldout_right",
        "heldout",
        "right",
        ((0.2, 0.0), (2.0, 0.07), (0.4, 0.07), (1.4, 0.035)),
        0.3,
    ),
)


def bends(current_limit: float = 5.0) -> list[dict[str, Any]]:
    """The trials as plain data for `Trial.from_plain`."""
    found = []
    for name, role, motor, moves, current in BENDS:
        other = "right" if motor == "left" else "left"
        waypoints = [list(move) for move in moves]
        follow = {"kind": "moves", "waypoints": waypoints}
        hold = {"kind": "constant", "value": current, "blend": 0.2}
        motors = {
            motor: {"mode": "displacement", "current_limit": current_limit, "profile": follow},
            other: {"mode": "current", "current_limit": current_limit, "profile": hold},
        }
        found.append({"name": name, "role": role, "duration": DURATION, "motors": motors})
    return found
