"""Logs of the arm as somebody else would write them: rotor angles in degrees, currents in mA."""

import numpy as np
import yaml

from spirob.logs.readers import read_table
from spirob.machine.arm.description import ArmFile
from spirob.plant import Plant, Rig
from spirob.trials import Trial
from spirob.trials.simulation import simulate
from tests.identify.known import TRIALS, moves

TURN = Rig().winch.gear_ratio / Rig().winch.radius  # rad of the rotor a metre wound in


def description(**changes):
    base = {
        "name": "arm",
        "time": {"column": "ms", "unit": "ms"},
        "body": "arm",
        **{
            motor: {
                "position": {"column": f"{motor} angle", "unit": "deg"},
                "effort": {"column": f"{motor} current", "unit": "mA"},
            }
            for motor in ("left", "right")
        },
    }
    return {**base, **changes}


def tables(paths):
    """Files as tables."""
    return [read_table(path) for path in paths]


def rig(**changes):
    return ArmFile.model_validate(description(**changes))


def log(role, k, true, effects=(), every=2):
    """Columns of a trial that the model played, at 500 Hz."""
    return played({"name": f"{role}_{k}", "role": role, **TRIALS[role][k]}, true, effects, k, every)


def long_log(true, effects=()):
    """Columns of ten seconds of strokes of the left motor."""
    strokes = [[0.3, 0.0]] + [[2.4, 0.05], [2.4, 0.02]] * 2
    plain = {"name": "long", "role": "train", **moves("left", strokes, 0.3), "duration": 10.0}
    return played(plain, true, effects)


def played(plain, true, effects=(), k=0, every=2):
    """Columns of this trial, played by the model with noise of seed `k`."""
    trace = simulate(Plant(Rig(), list(effects)), Trial.from_plain(plain), true, 0.002, seed=k)
    columns = {"ms": 1e3 * trace.seconds[::every] + 5000.0}
    for motor in ("left", "right"):
        angle = np.degrees(TURN * trace[f"{motor}.displacement"]) + 123.0
        columns[f"{motor} angle"] = angle[::every]
        columns[f"{motor} current"] = 1e3 * trace[f"{motor}.current"][::every]
    return columns


def write(folder, **changes):
    """The description as a file."""
    path = folder / "rig.yaml"
    path.write_text(yaml.safe_dump(description(**changes)))
    return path


def exchanged(columns):
    """The log with each motor's current in the other's column."""
    other = {"left current": "right current", "right current": "left current"}
    return {name: columns[other.get(name, name)] for name in columns}
