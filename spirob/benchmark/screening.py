"""How long the screening of the whole library takes: eight trials of 5 s, one effect hidden.

The trials are the model's own, with dry friction in the motors, numbers off nominal and the
sensor's noise.  Timed is one screening from the fitted numbers, once, after a single play of every
trial; its place in the ranking tells whether what was timed was of use.
"""

import time

from spirob.bench.simulate import simulate
from spirob.benchmark.identification import LOSS_SCALE, NAMES, TRUTH
from spirob.benchmark.trials import moving
from spirob.benchmark.turns import Size
from spirob.diagnosis.screen import screen
from spirob.effects import all_effects, find_effects
from spirob.identify.fit import fit
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual
from spirob.plant import Plant, Rig

HIDDEN = "coulomb_friction"
DEPTHS = (0.6, 0.9, 1.2, 1.5)  # of the strokes, on either side
LENGTH = 2.5  # of a trial, relative to the benchmark's others
NOISE = 0.005  # A


def measure(size: Size) -> dict[str, float]:
    """`screen_seconds`, `screened_effects`, `screened_place` of the hidden one, 1 the best."""
    hidden = find_effects([HIDDEN])
    truth = {**TRUTH, **{f"{HIDDEN}.{f}": p.nominal for f, p in hidden[0].parameters().items()}}
    machine = Plant(Rig(), hidden)
    trials = [
        moving(f"{side}_{depth}", side, LENGTH * size.seconds, depth)
        for side in ("left", "right")
        for depth in DEPTHS
    ]
    data = [
        Measurement.from_trace(simulate(machine, trial, truth, NOISE, seed))
        for seed, trial in enumerate(trials)
    ]
    candidates = list(all_effects().values())
    problem = Residual(Plant(Rig(), candidates), data)
    base = fit(problem, NAMES, {}, LOSS_SCALE, exact=False)
    begun = time.perf_counter()
    ranked = screen(problem, base, NAMES, candidates, LOSS_SCALE)
    seconds = time.perf_counter() - begun
    place = [s.effect.name() for s in ranked].index(HIDDEN) + 1
    return {
        "screen_seconds": seconds,
        "screened_effects": float(len(ranked)),
        "screened_place": float(place),
    }
