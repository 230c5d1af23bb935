"""A robot that made its own trials, and a search that ended where it is told to."""

from spirob.diagnosis.certainty import Ended
from spirob.diagnosis.conclusion import Weighed
from spirob.diagnosis.criteria import Settings
from spirob.diagnosis.fitting import Begun
from spirob.diagnosis.model import Found
from spirob.diagnosis.search import Search
from spirob.diagnosis.simulated import ROLES, Simulated
from spirob.diagnosis.verdict import Verdict
from spirob.identify.fit import fit
from spirob.identify.measurement import Measurement
from spirob.trials import Trial
from spirob.trials.simulation import simulate
from tests.identify.known import residual, spirob

NAMES = ["winch.efficiency"]
SETTINGS = Settings()
NOISE = 0.002  # A


class Robot:
    """A robot of which one of these effects is true, each with one number that is fitted.

    numbers  effect -> full name of that number;  true  numbers of the robot
    """

    def __init__(self, numbers, true):
        self.numbers, self.true = numbers, true
        self.plant = spirob(list(numbers))
        self.trials = {role: residual(self.plant, true, role, seed=3) for role in ROLES}
        train = self.trials["train"]
        self.fits = {
            effects: fit(train, [*NAMES, *(numbers[e] for e in effects)], {}, SETTINGS.scale)
            for effects in ((), *((e,) for e in numbers))
        }

    def ended(self, effect=None, settings=SETTINGS):
        """As if a search had fitted all of them, and ended with this one; with the best if None."""
        models = Simulated(self.trials, NAMES, settings, Begun(self.fits[()]))
        made = {e: models.added([e], self.fits[(e,)]) for e in self.numbers}
        best = min(made.values(), key=lambda m: m.mean_square) if effect is None else made[effect]
        found = Found([models.fitted((), {}), best])
        for e in best.effects:
            found.rivals[e.name()], found.equivalents[e.name()] = [], []
        search = Search(models, list(self.numbers), settings)
        return Ended(search, found, models.left(best))

    def played(self, experiment, true=None):
        """Its trials on the robot, by role, with noise of the sensor; on one with other numbers."""
        logs = {"train": [], "validate": []}
        for k, plain in enumerate(experiment.trials):
            trial = Trial.from_plain(plain)
            trace = simulate(self.plant, trial, true or self.true, NOISE, seed=k)
            logs[plain["role"]].append(Measurement.from_trace(trace))
        return logs


def beside(ended, kind="undecided"):
    """A verdict on it by which the other effect stands beside what was found."""
    (effect,) = ended.found.chosen.effects
    others = [e.name() for e in ended.search.candidates if e is not effect]
    told = {"rivals": others} if kind == "undecided" else {"equivalents": others}
    return Verdict(kind, {effect.name(): Weighed(0.6, 0.6, **told)}, "", "", "")
