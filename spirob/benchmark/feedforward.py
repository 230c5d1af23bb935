"""Cost of the exported feed-forward in C: a call with one effect, and with all that an axis has."""

import inspect
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from spirob.benchmark.timing import Size
from spirob.effects import Effect, all_effects
from spirob.errors import ConfigError
from spirob.export.axis import PLAYED, SIGNALS
from spirob.export.code import c_files
from spirob.export.corrected import Corrected, Fitted, Held
from spirob.export.law import law_of
from spirob.machine.description.rig import NUMBERS
from spirob.machine.laws import for_axis

CALLS = 1_000_000  # in a round of two seconds of trial; fewer in a shorter one
TIMED = """\
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <stdio.h>
#include <time.h>
#include "axis.h"

int main(void)
{
    axis_state state;
    struct timespec a, b;
    double sum = 0.0;
    axis_reset(&state);
    clock_gettime(CLOCK_MONOTONIC, &a);
    for (int k = 0; k < CALLS; k++) {
        const double t = 1e-3 * k, s = 0.8 * t - floor(0.8 * t) - 0.5;
        sum += axis_compensate(&state, s, 0.8 - s, 3.0 * s, 1e-3);
    }
    clock_gettime(CLOCK_MONOTONIC, &b);
    printf("%.17g %.17g\\n", ((b.tv_sec - a.tv_sec) + 1e-9 * (b.tv_nsec - a.tv_nsec)) / CALLS, sum);
    return 0;
}
"""


def measure(size: Size) -> dict[str, float]:
    """Median microseconds of a call, with Stribeck friction and with all effects of an axis."""
    everything = [
        e
        for e in for_axis(all_effects().values(), turned=10.0)
        if e.port in PLAYED and set(e.reads.values()) <= set(SIGNALS)
    ]
    one = [e for e in everything if e.name() == "stribeck_friction"]
    calls = round(CALLS * min(1.0, size.seconds / 2.0))
    return {
        "compensate_microseconds": 1e6 * _seconds(one, calls, size.repeats),
        "compensate_microseconds_all": 1e6 * _seconds(everything, calls, size.repeats),
        "compensate_effects": float(len(everything)),
    }


def _seconds(effects: Sequence[type[Effect]], calls: int, repeats: int) -> float:
    compiler = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    if compiler is None:
        raise ConfigError("the cost of the feed-forward needs a C compiler; none is here")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name, text in {**c_files(_axis(effects)), "main.c": TIMED}.items():
            (folder / name).write_text(text, encoding="utf-8")
        command = [compiler, "-std=c99", "-O2", f"-DCALLS={calls}", "-o", "main", "main.c"]
        subprocess.run([*command, "axis.c", "-lm"], cwd=folder, check=True)
        runs = [
            subprocess.run(["./main"], cwd=folder, check=True, capture_output=True, text=True)
            for _ in range(repeats)
        ]
    return float(np.median([float(run.stdout.split()[0]) for run in runs]))


def _axis(effects: Sequence[type[Effect]]) -> Corrected:
    """An axis with these effects at their nominal numbers."""
    held = []
    for effect in effects:
        text = inspect.getsource(inspect.getmodule(effect))  # type: ignore[arg-type]
        values = {name: about.nominal for name, about in effect.parameters().items()}
        held.append(Held(law_of(effect.name(), text, effect), values))
    numbers = dict.fromkeys(NUMBERS, 0.0) | {"inertia": 0.02, "viscous": 0.03, "scale": 0.5}
    nothing = Fitted((), (), (), (), (), None)
    return Corrected(
        "axis", "named", "", "rad", "A", "N·m", numbers, 1.0, 0.05, 0.3, 1e-3, tuple(held), nothing
    )
