"""How long the screening of the library takes, and `spirob diagnose` as a whole.

The servo is a rotor under a digital controller at 1 kHz, its encoder counts 32768 to a turn; dry
friction and cogging are hidden.  Three logs, the last of them held out.  The command runs as a
process of its own, once before it is timed, so that its kernels are compiled; what it names tells
whether what was timed was of use.

The screening has eight trials of 5 s, with one effect hidden.  They are the model's own, with dry
friction in the motors, numbers off nominal and the sensor's noise.  Timed is one screening from the
fitted numbers, once, after a single play of every trial; its place in the ranking tells whether
what was timed was of use.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from spirob.benchmark.identification import LOSS_SCALE, NAMES, TRUTH
from spirob.benchmark.timing import Size, moving
from spirob.diagnosis.screen import screen
from spirob.effects import all_effects, find_effects
from spirob.identify.fit import fit
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual
from spirob.plant import Plant, Rig
from spirob.trials.simulation import simulate

ROWS = {"10k": 10_000, "100k": 100_000}  # of all logs
LEAST = 8_000  # rows of a short round: seconds of motion in each log
SHARES = (0.4, 0.4, 0.2)  # of them in each log
HIDDEN = {"coulomb_friction", "cogging"}
PERIOD, SUBSTEPS = 1e-3, 4
INERTIA, VISCOUS, DRY, COGGING, TEETH = 0.02, 0.05, 0.15, 0.08, 7.0
COUNT = 2 * math.pi / 32768
NOISE = 0.01  # N·m
RIG = """
name: servo of the benchmark
time: {column: time, unit: s}
position: {column: position, unit: rad}
effort: {column: torque, unit: N·m, kind: torque, origin: measured}
fit:
  inertia: {nominal: 0.015, low: 1.0e-4, high: 1.0}
  viscous: {nominal: 0.03, low: 0.0, high: 1.0}
"""


def measure(size: Size) -> dict[str, float]:
    """Of 10 000 and of 100 000 rows; `diagnosis_named` is how many of the two are named.

    `diagnosis_seconds_10k` pass, `diagnosis_core_seconds_10k` are those that all cores worked for
    it, whatever else they did.
    """
    figures: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for label, rows in ROWS.items():
            logs = _logs(folder, max(LEAST, int(rows * size.seconds / Size.seconds)))
            if not figures and size.slow_repeats > 1:  # who only tries may time a compilation
                _diagnose(folder, logs)
            passed, worked = _diagnose(folder, logs)
            figures[f"diagnosis_seconds_{label}"] = passed
            figures[f"diagnosis_core_seconds_{label}"] = worked
        found = json.loads((folder / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    figures["diagnosis_named"] = float(len(HIDDEN & {e["name"] for e in found["effects"]}))
    return figures


def _diagnose(folder: Path, logs: list[str]) -> tuple[float, float]:
    """Seconds of one run of the command: that passed, and that cores worked for it."""
    command = [sys.executable, "-m", "spirob.cli.main", "diagnose", "--quiet"]
    command += ["--rig", "rig.yaml", "--train", *logs[:-1], "--test", logs[-1], "--out", "out"]
    begun, before = time.perf_counter(), os.times()
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    passed, after = time.perf_counter() - begun, os.times()
    user = after.children_user - before.children_user
    return passed, user + after.children_system - before.children_system


def _logs(folder: Path, rows: int) -> list[str]:
    """Written logs of so many rows in all, and the rig's description beside them."""
    (folder / "rig.yaml").write_text(RIG, encoding="utf-8")
    names = []
    for k, share in enumerate(SHARES):
        names.append(f"log{k}.csv")
        header = "time,position,torque"
        table = _servo(round(rows * share), np.random.default_rng(k))
        np.savetxt(folder / names[-1], table, delimiter=",", header=header, comments="")
    return names


def _servo(count: int, random: np.random.Generator) -> np.ndarray:
    """Time [s], position [rad] and torque [N·m] as they would be logged, (count, 3)."""
    t = PERIOD * np.arange(count)
    speeds, phases = 2 * np.pi * random.uniform(0.1, 1.5, 8), random.uniform(0.0, 2 * np.pi, 8)
    sizes = random.uniform(0.5, 2.0, 8) / speeds
    wanted = (sizes * np.sin(np.outer(t, speeds) + phases)).sum(axis=1)
    fast = (sizes * speeds * np.cos(np.outer(t, speeds) + phases)).sum(axis=1)
    q, v, step = float(wanted[0]), 0.0, PERIOD / SUBSTEPS
    position, torque = np.empty(count), np.empty(count)
    for k in range(count):
        position[k] = q
        torque[k] = push = 8.0 * (wanted[k] - q) + 0.8 * (fast[k] - v)
        for _ in range(SUBSTEPS):
            lost = VISCOUS * v + DRY * math.tanh(100.0 * v) + COGGING * math.sin(TEETH * q)
            v += step * (push - lost) / INERTIA
            q += step * v
    seen = np.round(position / COUNT) * COUNT
    return np.column_stack([t, seen, torque + random.normal(0.0, NOISE, count)])


SCREENED = "coulomb_friction"
DEPTHS = (0.6, 0.9, 1.2, 1.5)  # of the strokes, on either side
LENGTH = 2.5  # of a trial, relative to the benchmark's others
CURRENT_NOISE = 0.005  # A


def measure_screening(size: Size) -> dict[str, float]:
    """`screen_seconds`, `screened_effects`, `screened_place` of the hidden one, 1 the best."""
    hidden = find_effects([SCREENED])
    truth = {**TRUTH, **{f"{SCREENED}.{f}": p.nominal for f, p in hidden[0].parameters().items()}}
    machine = Plant(Rig(), hidden)
    trials = [
        moving(f"{side}_{depth}", side, LENGTH * size.seconds, depth)
        for side in ("left", "right")
        for depth in DEPTHS
    ]
    data = [
        Measurement.from_trace(simulate(machine, trial, truth, CURRENT_NOISE, seed))
        for seed, trial in enumerate(trials)
    ]
    candidates = list(all_effects().values())
    problem = Residual(Plant(Rig(), candidates), data)
    base = fit(problem, NAMES, {}, LOSS_SCALE, exact=False)
    begun = time.perf_counter()
    ranked = screen(problem, base, NAMES, candidates, LOSS_SCALE)
    seconds = time.perf_counter() - begun
    place = [s.effect.name() for s in ranked].index(SCREENED) + 1
    return {
        "screen_seconds": seconds,
        "screened_effects": float(len(ranked)),
        "screened_place": float(place),
    }
