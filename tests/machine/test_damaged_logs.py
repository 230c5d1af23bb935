"""Any mixture of damages around a known machine: the same answer, or a true sentence.

The machine's position, speed and effort are known at any time.  A log of it is damaged as loggers
do; what `prepare` makes of it is compared with the truth on the rows that it would compare.  When
a stretch began and where its zero lies is not in a damaged log, and is found by fitting.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from spirob.errors import DataError
from spirob.machine.axis import diagnose_recordings
from spirob.machine.filtering import smooth
from spirob.machine.positions import ANOTHER
from spirob.machine.recording import Recording, prepare
from spirob.machine.rig import RigFile
from tests.machine.rigs import description

TURN = 2 * np.pi
LENGTH = 12.0
TONES = TURN * np.array([0.31, 0.83, 1.37])
SIZES = np.array([1.5, 0.8, 0.3])
PHASES = np.array([0.3, 1.1, 2.0])
FINE = np.arange(-1.0, LENGTH + 1.0, 1e-3)
BLOCK = 2.0  # s, within which the clock may be off by no more than a part of a sample
FEW = 50  # rows of a block, by which it is told about when it began
FAR = 0.06  # of the RMS of speed and effort: a third of a sample at 50 Hz
BLURRED = 0.15  # of most blocks, where samples are lost behind stamps that do not tell which


def motion(t):
    angles = np.outer(t, TONES) + PHASES
    return np.sin(angles) @ SIZES, np.cos(angles) @ (SIZES * TONES)


def effort(t):
    q, v = motion(t)
    return 0.3 * np.sin(q) + 0.05 * v


RATE, EFFORT = motion(FINE)[1], effort(FINE)


class Log:
    """Columns as they were true, with noise, and what is known of their time."""

    def __init__(self, rate: float, seed: int):
        self.rng, self.rate = np.random.default_rng(seed), rate
        self.true = np.arange(0.0, LENGTH, 1.0 / rate)
        q, v = motion(self.true)
        noise = self.rng.standard_normal((3, len(q)))
        self.columns = {
            "t": self.true.copy(),
            "q": q + 1e-4 * noise[0],
            "v": v + 1e-3 * noise[1],
            "u": effort(self.true) + 1e-3 * noise[2],
        }
        self.unit = "s"
        self.modulus: float | None = None

    def rows(self, keep):
        """Only some rows of all columns, in their order."""
        self.columns = {name: values[keep] for name, values in self.columns.items()}

    def __len__(self) -> int:
        return len(self.columns["t"])


def epoch(log: Log) -> None:
    log.columns["t"] = 1.7e9 + log.columns["t"]


def coarse(log: Log) -> None:
    tick = log.rng.integers(2, 6) / log.rate
    log.columns["t"] = tick * np.floor(log.columns["t"] / tick + 1e-9)


def late(log: Log) -> None:
    size = log.rng.uniform(0.1, 0.6) / log.rate
    log.columns["t"] = np.maximum.accumulate(log.columns["t"] + size * log.rng.random(len(log)))


def lossy(log: Log) -> None:
    log.rows(log.rng.random(len(log)) >= log.rng.uniform(0.0, 0.05))


def gap(log: Log) -> None:
    begin = log.rng.integers(len(log) // 4, len(log) // 2)
    log.rows(np.delete(np.arange(len(log)), slice(begin, begin + len(log) // 8)))


def restarted(log: Log) -> None:
    at = log.rng.integers(len(log) // 3, len(log) // 2)
    log.columns["t"][at:] -= log.columns["t"][at] - log.columns["t"][0]


def corrupt_stamps(log: Log) -> None:
    rows = log.rng.integers(5, len(log) - 5, 2)
    log.columns["t"][rows] = log.rng.choice([0.0, 1e12, np.nan], 2)


def repeated(log: Log) -> None:
    log.rows(np.repeat(np.arange(len(log)), 2))


def wrapped(log: Log) -> None:
    log.modulus = float(log.rng.choice([TURN, TURN / 2, 2.0]))
    begin = log.rng.uniform(0.0, log.modulus)
    log.columns["q"] = np.mod(log.columns["q"] + begin, log.modulus)


def spikes(log: Log) -> None:
    rows = 10 * log.rng.choice(len(log) // 10 - 2, 2, replace=False) + 5
    log.columns["q"][rows] += log.rng.choice([-1.0, 1.0], 2) * log.rng.uniform(50.0, 500.0, 2)


def missing(log: Log) -> None:
    for name in ("q", "u", "v"):
        log.columns[name][log.rng.random(len(log)) < 0.01] = np.nan


def missing_run(log: Log) -> None:
    name = log.rng.choice(["q", "u"])
    at = log.rng.integers(len(log) // 4, len(log) // 2)
    log.columns[name][at : at + len(log) // 10] = np.nan


def jump(log: Log) -> None:
    at = log.rng.integers(len(log) // 4, 3 * len(log) // 4)
    log.columns["q"][at:] += 27.3


def scaled_speed(log: Log) -> None:
    log.columns["v"] *= log.rng.choice([0.4, 0.5, 2.0, -1.0, 57.3])


def late_speed(log: Log) -> None:
    samples = int(log.rng.integers(1, 4))
    log.columns["v"] = np.concatenate([np.full(samples, np.nan), log.columns["v"][:-samples]])


def no_speed(log: Log) -> None:
    log.columns["v"] = log.rng.standard_normal(len(log))


# in the order in which a log suffers them: of the machine and its sensors, then of the logger
DAMAGES: list[Callable[[Log], None]] = [
    *(wrapped, jump, spikes, scaled_speed, late_speed, no_speed, missing, missing_run),
    *(lossy, gap, late, coarse, repeated, restarted, epoch, corrupt_stamps),
]


SPEEDS = (scaled_speed, late_speed, no_speed)
MIXTURES = given(
    st.sampled_from([50.0, 100.0, 200.0, 500.0]),
    st.sets(st.integers(0, len(DAMAGES) - 1), max_size=5),
    st.booleans(),
    st.integers(0, 2**32),
)  # rate, damages, with a speed, seed


def rig(with_speed: bool) -> RigFile:
    speed = {"velocity": {"column": "v", "unit": "rad/s"}} if with_speed else {}
    return RigFile.model_validate(description(filter={}, **speed))


def missed(made: Recording) -> np.ndarray:
    """RMS errors of speed or effort on the compared rows, over the truth's, of each block."""
    found = []
    true = np.array([RATE, smooth(EFFORT, made.cutoff, 1e-3)])
    for piece in made.pieces:
        rows = np.flatnonzero(piece.use)
        for block in np.array_split(rows, max(1, round(len(rows) * made.period / BLOCK))):
            heard = np.array([piece.v[block], piece.effort[block]])
            found.append(_missed(piece.seconds[block], heard, true))
    return np.array(found)


def _missed(seconds, heard, true):
    """The larger of both for a block; it began when both together fit best.

    heard  speed and effort, (2, N);  true  the same at the times of FINE
    """
    sizes = true.std(axis=1)

    def errors(begins: np.ndarray, every: int = 1) -> np.ndarray:
        """Of each begin, (2, B), by every n-th row."""
        times = seconds[::every] + np.reshape(begins, (-1, 1))
        at = np.array([np.interp(times, FINE, values) for values in true])
        apart = at - heard[:, None, ::every]
        return np.sqrt(np.mean(apart**2, axis=2)) / sizes[:, None]

    def off(begin: float) -> float:
        return float(np.hypot(*errors(begin)[:, 0]))

    tried = np.arange(-1.0 - seconds[0], LENGTH - seconds[-1] + 1.0, 0.02)
    few = max(1, len(seconds) // FEW)
    near = tried[int(np.argmin(np.hypot(*errors(tried, few))))]
    best = minimize_scalar(off, bounds=(near - 0.03, near + 0.03), method="bounded").x
    return float(errors(best).max())


@settings(max_examples=150, deadline=None, derandomize=True)
@MIXTURES
@example(200.0, set(range(len(DAMAGES))), True, 0)
def test_a_damaged_log_gives_the_same_motion_or_a_sentence(rate, damages, with_speed, seed):
    log = Log(rate, seed)
    hurt = {DAMAGES[k] for k in damages}
    for k in sorted(damages):
        DAMAGES[k](log)
    try:
        made = prepare("log", log.columns, rig(with_speed))
    except DataError as error:
        assert str(error).startswith("log: ")
        assert "\n" not in str(error)
        return
    if {lossy, gap} & hurt and {late, coarse} & hurt:
        assert np.median(missed(made)) < BLURRED, made.said
    else:
        assert missed(made).max() < FAR, made.said
    assert damages or made.said == []


@settings(max_examples=4, deadline=None, derandomize=True)
@MIXTURES
@example(200.0, {DAMAGES.index(jump)}, True, 0)
def test_a_damaged_log_gives_the_same_answer_or_a_sentence(rate, damages, with_speed, seed):
    log, described = Log(rate, seed), rig(with_speed)
    for k in sorted(damages):
        DAMAGES[k](log)
    try:
        made = prepare("log", log.columns, described)
    except DataError as error:
        assert str(error).startswith("log: ")
        return
    found = diagnose_recordings(described, Path(), [made], [])
    right = found.verdict == "named" and [f.name for f in found.findings] == ["tip_payload"]
    assert right or any(ANOTHER in said for said in found.notes), found.sentence


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    st.sampled_from([50.0, 100.0, 200.0, 500.0]),
    st.sampled_from(DAMAGES),
    st.booleans(),
    st.integers(0, 2**32),
)
def test_a_single_damage_is_always_repaired(rate, damage, with_speed, seed):
    log = Log(rate, seed)
    damage(log)
    made = prepare("log", log.columns, rig(with_speed))
    assert missed(made).max() < FAR
    unseen = damage in (epoch, late, lossy) or (damage in SPEEDS and not with_speed)
    assert made.said or unseen
