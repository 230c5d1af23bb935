"""A log of a known machine, and what loggers do to one."""

from collections.abc import Callable

import numpy as np

TURN = 2 * np.pi
LENGTH = 12.0

Machine = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]


class Log:
    """Columns as they were true, with noise, and what is known of their time."""

    def __init__(self, machine: Machine, rate: float, seed: int, length: float = LENGTH):
        """`machine` gives position, speed and effort at any time [s]; `length` in s."""
        self.rng, self.rate = np.random.default_rng(seed), rate
        self.true = np.arange(0.0, length, 1.0 / rate)
        q, v, u = machine(self.true)
        noise = self.rng.standard_normal((3, len(q)))
        self.columns = {
            "t": self.true.copy(),
            "q": q + 1e-4 * noise[0],
            "v": v + 1e-3 * noise[1],
            "u": u + 1e-3 * noise[2],
            "felt": v,  # the speed by which the controller acts, whatever the log says of it
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
    """By a turn, two of them, 25 rad, half a turn (4096 of 8192 counts): the motion goes over."""
    log.modulus = float(log.rng.choice([TURN, 2 * TURN, 25.0, TURN / 2, 2.0]))
    q = log.columns["q"]
    edge = log.rng.uniform(q.min(), q.max())
    log.columns["q"] = np.mod(q - edge, log.modulus)


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


def burst(log: Log) -> None:
    """An effort many times too large for a while."""
    at, rows = log.rng.integers(len(log) // 10, len(log) // 2), log.rng.uniform(0.1, 1.5) * log.rate
    times = log.rng.choice([-1.0, 1.0]) * 10.0 ** log.rng.uniform(1.0, 2.5)
    log.columns["u"][at : at + int(rows)] *= times


# in the order in which a log suffers them: of the machine and its sensors, then of the logger
DAMAGES: list[Callable[[Log], None]] = [
    *(wrapped, jump, spikes, scaled_speed, late_speed, no_speed, missing, missing_run),
    *(lossy, gap, late, coarse, repeated, restarted, epoch, corrupt_stamps),
]
