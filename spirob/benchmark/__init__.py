"""How fast the model and what is built on it run, as ratios measured in one run.

Each file measures one thing: `measure(size)` returns figures by key.  What is compared is run in
turns, so that whatever else the machine does falls on both sides alike, and medians are reported.

timing.py          what is timed and how: cycles, threads, decoding
identification.py  the fit, against `mujoco.sysid`
diagnosis.py       the screening of the library, and a whole diagnosis of a rig
feedforward.py     the exported feed-forward in C
intervals.py       how honest the intervals of a fit are, and what a known weight adds
"""

from collections.abc import Callable

from spirob.benchmark import diagnosis, feedforward, identification, timing
from spirob.benchmark.timing import Size

MEASURES: dict[str, Callable[[Size], dict[str, float]]] = {
    "coupled_tick": timing.measure_cycles,
    "threads": timing.measure_threads,
    "decoding": timing.measure_decoding,
    "identification": identification.measure,
    "screening": diagnosis.measure_screening,
    "diagnosis": diagnosis.measure,
    "feedforward": feedforward.measure,
}
