"""Play a trial in the model and return what its log would decode to."""

from collections.abc import Mapping

import numpy as np

from spirob.bench.trial import Trial
from spirob.can_protocol import AMPERE_PER_COUNT
from spirob.logs.reader import CHANNELS, FILTER_WINDOW
from spirob.plant import Plant
from spirob.robot import CYCLE_NS, MOTORS
from spirob.trace import Trace, moving_average


def simulate(
    plant: Plant,
    trial: Trial,
    changes: Mapping[str, float],
    current_noise: float = 0.0,
    seed: int = 0,
) -> Trace:
    """The trial as a decoded trace: current in counts of the drive, with sensor noise.

    current_noise  standard deviation [A];  seed  of the noise
    Raises SimulationError when the model diverges.
    """
    schedule = trial.schedule()
    response = plant.simulate(schedule, trial.scene, changes)
    noise = np.random.default_rng(seed).normal(0.0, 1.0, response.current.shape) * current_noise
    current = np.round((response.current + noise) / AMPERE_PER_COUNT) * AMPERE_PER_COUNT
    signals: dict[str, np.ndarray] = {}
    for m, motor in enumerate(MOTORS):
        signals |= {
            f"{motor}.current": current[:, m],
            f"{motor}.current_filtered": moving_average(current[:, m], FILTER_WINDOW, trial.name),
            f"{motor}.displacement": response.displacement[:, m],
            f"{motor}.velocity": response.velocity[:, m],
            f"{motor}.command": response.command[:, m],
            f"{motor}.reference": schedule.reference[:, m],
            f"{motor}.reference_rate": schedule.reference_rate[:, m],
            f"{motor}.mode": np.full(schedule.cycles, float(schedule.mode[m])),
        }
    units = {name: CHANNELS.get(name.split(".")[1], "") for name in signals}
    plain = dict(trial.plain)
    meta = {"role": trial.role, "trial": plain, "scene": plain.get("scene") or {}}
    time = np.arange(schedule.cycles, dtype=np.int64) * CYCLE_NS
    return Trace(trial.name, time, signals, units, meta)
