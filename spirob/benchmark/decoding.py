"""How many samples of a trial a second of decoding yields (a sample: one cycle, both motors)."""

import tempfile
from pathlib import Path

import numpy as np

from spirob.bench import record
from spirob.bench.simulated import SimulatedRobot
from spirob.benchmark.trials import moving
from spirob.benchmark.turns import Size, in_turns
from spirob.logs import Transmission, read_log
from spirob.plant import Plant, Rig


def measure(size: Size) -> dict[str, float]:
    """`decode_samples_per_second` [1/s] of a log recorded for the purpose."""
    rig = Rig()
    trial = moving("decoding", "left", 5.0 * size.seconds)
    with tempfile.TemporaryDirectory() as folder:
        path = record(
            trial,
            SimulatedRobot(Plant(rig)),
            Path(folder) / "trial.mcap",
            transmission=Transmission(),
            gains=rig.gains,
            rig=rig.name,
        )
        taken = in_turns({"decode": lambda: read_log(path)}, size.repeats)
        samples = len(read_log(path))
    return {"decode_samples_per_second": samples / float(np.median(taken["decode"]))}
