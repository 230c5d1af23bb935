"""Model minus measurement, filtered alike on both sides and weighted to one unit.

The current of a motor that follows a velocity, displacement or force is what its load demands, and
is compared in ampere.  A motor whose current is commanded shows nothing of its load there: that
shows in its motion, and the length that it has wound in is compared too, at so many ampere a metre.
What stretches, creeps or winds up shows there more clearly than in any current.  Its current is
compared as well, for it says whether the drive gives what it is told: a dead band stays short of
the command, a sensor that is wrong does not.

Where a trial's cycles have weights, model and measurement are multiplied by them.

`near` is a replay at half the price, for a search that stays near one point.  The model is played
in steps of a whole cycle, and what that misses at one point p_0 is put right,

    r(p) ≈ r_1(p) + r_2(p_0) - r_1(p_0),

r_2 being the residual in the plant's own steps.  What is left is the change of the discretisation's
error between the two points.

`refuse_senseless` asks whether the currents belong to the motions at all: what the fitted model
explains of each log says it.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from statistics import median

import numpy as np
import scipy

from spirob.control import CURRENT, DISPLACEMENT, VELOCITY
from spirob.errors import DataError, SimulationError
from spirob.identify.intervals import score
from spirob.identify.measurement import Measurement
from spirob.identify.problem import Effort, Problem, Rotor, Stretch, compared, effort_rms
from spirob.logs.trace import moving_average
from spirob.parameter import Table
from spirob.plant import Plant, Response
from spirob.robot import MOTORS

STILL = 1e-3  # m/s, slower is standing
BLOCK = 0.5  # s, over which a residual is correlated at most


@dataclass(frozen=True)
class Filter:
    """The filter that both sides of a residual pass.

    kind     "butterworth" (4th order, zero phase) or "moving_average" (the paper's, causal)
    cutoff   [Hz], for butterworth;  window  [samples], for moving_average
    every    keep every n-th sample of the 1 kHz signal after filtering
    """

    kind: str = "butterworth"
    cutoff: float = 30.0
    window: int = 100
    every: int = 10

    def __call__(self, values: np.ndarray, name: str = "signal") -> np.ndarray:
        """Filter 1 kHz signals along the last axis, same shape; raises TooShort."""
        if self.kind == "moving_average":
            return np.apply_along_axis(moving_average, -1, values, self.window, name)
        return scipy.signal.sosfiltfilt(self._sections, values)

    @cached_property
    def _sections(self) -> np.ndarray:
        order = 2  # doubled by both passes
        return scipy.signal.butter(order, self.cutoff, fs=1000.0, output="sos")

    def thin(self, values: np.ndarray, name: str = "signal") -> np.ndarray:
        """Filter, then keep every n-th sample."""
        return self(values, name)[:: self.every]


@dataclass
class Residual:
    """The residual of a set of trials as a function of the parameters.

    current   "current" (i*, what a current sensor sees) or "arm_current" (the paper's i**).
              On data made by the model itself a fit on i* ends at the noise (1.1 mA) with η right
              to 0.1 %; on i** it ends at 9 mA with η 13 % off, because i** multiplies differences
              between rotor and arm by J_eq/r², kilograms
    length    weight of a wound-in length [A/m]; 0 leaves it out.  Two builds of one arm, one with
              24 hinges and one with 48, differ by 1 mm and by 1 % of the current, 5 mA: 5 A/m.  The
              other motor's current is compared where its length is
    workers   threads; the compiled loop runs without the GIL
    """

    plant: Plant
    trials: Sequence[Measurement]
    filter: Filter = field(default_factory=Filter)
    current: str = "current"
    length: float = 5.0
    workers: int = 2

    def __post_init__(self) -> None:
        self._measured = [self._signals(t, t.current, t.displacement) for t in self.trials]
        sizes = [len(m) for m in self._measured]
        self.edges = np.concatenate([[0], np.cumsum(sizes)])
        self.rows = np.concatenate([self._rows(t) for t in self.trials] or [np.zeros(0, bool)])

    @property
    def table(self) -> Table:
        """All numbers of the plant."""
        return self.plant.table

    @property
    def block(self) -> int:
        """Samples of the residual in half a second."""
        return max(1, round(1e3 * BLOCK / self.filter.every))

    @property
    def effort(self) -> Effort:
        """The residual is in ampere of motor current."""
        return Effort("motor current", "A")

    def stretches(self) -> list[Stretch]:
        """One stretch for each driven motor of each trial."""
        return [self._stretch(t, m) for t in self.trials for m in self.driven(t)]

    def rotors(self) -> list[list[Rotor]]:
        """All motors of each trial; their angles follow from the lengths they have wound in."""
        winch = self.plant.rig.winch
        turn = winch.gear_ratio / winch.radius  # rad/m
        return [
            [
                Rotor(
                    t.first_angle[m] + t.displacement[:, m] * turn,
                    t.current[:, m],
                    self.filter.every,
                    t.use,
                )
                for m in range(len(MOTORS))
            ]
            for t in self.trials
        ]

    def raw(self) -> list[np.ndarray]:
        """Unfiltered samples of each driven motor's current in each trial [A], where compared."""
        used = [(t, compared(len(t.current), t.every, t.use)) for t in self.trials]
        return [t.current[rows, m] for t, rows in used for m in self.driven(t)]

    def spaced(self) -> list[int]:
        """Cycles between the samples of each of `raw`."""
        return [t.every for t in self.trials for _ in self.driven(t)]

    def cycles(self, trial: Measurement) -> np.ndarray:
        """The cycles of a trial that are compared: every n-th one that is not left out."""
        return compared(len(trial.current), self.filter.every, trial.use)

    def thin(self, values: np.ndarray, trial: Measurement) -> np.ndarray:
        """Filter a signal of the whole trial, (T,), then keep what of it is compared."""
        return self.filter(values, trial.name)[self.cycles(trial)]

    def driven(self, trial: Measurement) -> list[int]:
        """Motors whose current is not commanded."""
        return [m for m, mode in enumerate(trial.schedule.mode) if mode != CURRENT]

    def measured(self) -> np.ndarray:
        """What was measured, in the order of the residual [A]; `rows` are the motor currents."""
        return np.concatenate(self._measured)

    def __call__(self, changes: Mapping[str, float]) -> np.ndarray:
        """Model minus measurement for all trials, one vector [A]."""
        return self.many([changes])[0]

    def many(self, points: Sequence[Mapping[str, float]]) -> list[np.ndarray]:
        """Residuals at several parameter points, all simulations in parallel."""
        jobs = [(point, k) for point in points for k in range(len(self.trials))]
        with ThreadPoolExecutor(self.workers) as pool:
            parts = list(pool.map(lambda job: self.one(*job), jobs))
        count = len(self.trials)
        return [np.concatenate(parts[i * count : (i + 1) * count]) for i in range(len(points))]

    def one(self, changes: Mapping[str, float], index: int) -> np.ndarray:
        """The residual of one trial [A]."""
        trial = self.trials[index]
        response = self.respond(changes, index)
        current = getattr(response, self.current)
        return self._signals(trial, current, response.displacement) - self._measured[index]

    def respond(self, changes: Mapping[str, float], index: int) -> Response:
        """The model's full response in one trial."""
        trial = self.trials[index]
        return self.plant.simulate(trial.schedule, trial.scene, changes, trial.first_angle)

    def weight(self, trial: Measurement) -> np.ndarray:
        """Of each cycle of a trial that is compared."""
        cycles = self.cycles(trial)
        return np.ones(len(cycles)) if trial.weight is None else trial.weight[cycles]

    def unweighted(self) -> "Residual":
        """The same with all cycles of its trials counting alike."""
        return replace(self, trials=[replace(trial, weight=None) for trial in self.trials])

    def _stretch(self, trial: Measurement, motor: int) -> Stretch:
        position, velocity, current = (
            self.thin(values[:, motor], trial)
            for values in (trial.displacement, trial.velocity, trial.current)
        )
        winch, cycles, schedule = self.plant.rig.winch, self.cycles(trial), trial.schedule
        commanded = {VELOCITY: trial.velocity, DISPLACEMENT: trial.displacement}
        followed = commanded.get(int(schedule.mode[motor]))  # of a force nothing is measured
        heat = trial.temperature
        return Stretch(
            trial.name,
            f"{MOTORS[motor]} motor",
            trial.seconds[cycles],
            position,
            velocity,
            current,
            STILL,
            "winding in",
            "paying out",
            angle=trial.first_angle[motor] + position * winch.gear_ratio / winch.radius,
            gear=winch.gear_ratio,
            lag=None
            if followed is None
            else self.thin(schedule.reference[:, motor] - followed[:, motor], trial),
            command_rate=self.thin(np.gradient(schedule.reference[:, motor], 1e-3), trial),
            temperature=None if heat is None else heat[cycles, motor],
        )

    def _others(self, trial: Measurement) -> list[int]:
        """Motors whose length is compared: beside one that pulls."""
        driven = self.driven(trial)
        if not driven or self.length == 0.0:
            return []
        return [m for m in range(len(MOTORS)) if m not in driven]

    def _signals(
        self, trial: Measurement, current: np.ndarray, displacement: np.ndarray
    ) -> np.ndarray:
        parts = [self.thin(current[:, m], trial) for m in self.driven(trial)]
        parts += [self.length * self.thin(displacement[:, m], trial) for m in self._others(trial)]
        parts += [self.thin(current[:, m], trial) for m in self._others(trial)]
        weight = self.weight(trial)
        return np.concatenate([weight * part for part in parts] or [np.zeros(0)])

    def _rows(self, trial: Measurement) -> np.ndarray:
        samples = len(self.cycles(trial))
        kinds = [True] * len(self.driven(trial)) + [False] * 2 * len(self._others(trial))
        return np.repeat(np.array(kinds, dtype=bool), samples)


MOST = 0.02  # of the effort's RMS: with a larger correction the long steps are not to be trusted


@dataclass
class Near(Residual):
    """The residual of `exact` close to one point; `correction` (N,) is added to what it finds."""

    exact: Residual = field(kw_only=True)
    correction: np.ndarray = field(kw_only=True)

    def one(self, changes: Mapping[str, float], index: int) -> np.ndarray:
        """The residual of one trial; in the plant's own steps where the long ones diverge."""
        try:
            found = super().one(changes, index)
        except SimulationError:
            return self.exact.one(changes, index)
        return found + self.correction[self.edges[index] : self.edges[index + 1]]


def near(problem: Problem, changes: Mapping[str, float]) -> Problem:
    """The problem at half the price near these numbers; itself where it has no cheaper one."""
    if not isinstance(problem, Residual) or problem.plant.substeps == 1:
        return problem
    own = {f.name: getattr(problem, f.name) for f in fields(Residual)}
    own["plant"] = problem.plant.coarse()
    try:
        correction = problem(changes) - Residual(**own)(changes)
    except SimulationError:
        return problem
    if np.sqrt(np.mean(correction**2)) > MOST * effort_rms(problem):
        return problem
    return Near(**own, exact=problem, correction=correction)


SENSE = 0.3  # R² below which the currents do not belong to this motion
SUSPECTS = "are the columns of the two motors exchanged, a sign or a unit wrong?"


def explained(residual: Residual, missed: np.ndarray) -> dict[str, float]:
    """R² of the driven motors' current, log by log; logs that command every current have none.

    missed  model minus measurement of all logs, as `residual` gives it [A]
    """
    measured, found = residual.measured(), {}
    for k, trial in enumerate(residual.trials):
        own = slice(residual.edges[k], residual.edges[k + 1])
        rows = residual.rows[own]
        if rows.any():
            want = measured[own][rows]
            found[trial.name] = score(want, want + missed[own][rows]).r2
    return found


def refuse_senseless(residual: Residual, missed: np.ndarray) -> None:
    """Raise DataError, naming the worst log, where less than SENSE of them is explained.

    Of all together, or of the median log: numbers that are fitted to exchanged motors explain how
    much one log asks beside another, and hardly what happens in either.  A search for effects in
    such logs would find what makes up for the mistake.
    """
    rows = residual.rows
    measured = residual.measured()[rows]
    logs = explained(residual, missed)
    told = min(score(measured, measured + missed[rows]).r2, median(logs.values()))
    if told < SENSE:
        worst = min(logs, key=logs.__getitem__)
        raise DataError(
            f"the fitted model explains {max(0.0, told):.0%} of the current's variance, "
            f"least in {worst}: {SUSPECTS}"
        )
