"""The steps of the ladder: what was fitted, and how well each does on every role of trials."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np
from pydantic import Field

from spirob.diagnosis.evidence import block_errors, complete
from spirob.diagnosis.screen import Screened
from spirob.effects import Effect
from spirob.effects.effect import differences
from spirob.identify.builds import RESOLUTION, Builds, Floor, floor_of, weighted
from spirob.identify.fit import Fit
from spirob.identify.problem import Effort, Problem
from spirob.identify.residual import Residual
from spirob.score import Score, score

ROLES = ("train", "validate", "heldout")


@dataclass(frozen=True)
class Rules:
    """How the search decides, as a configuration says it (`diagnose`).

    finalists    candidates confirmed in full simulation in the first round; one less in each after
    rounds       effects added at most
    further      least size of a second effect, relative to the first: a law of the library is never
                 quite that of the machine, and what is left of its form is no effect of its own
    confidence   an effect is named when no rival wins more than the rest of the resampled errors
    alike        two candidates whose residuals differ by less than this share of the effect's size
                 say the same of the data, and count as one
    iterations   sets of differences in the fit of a finalist
    patience     sets of differences in a last fit, and in the fit of the parameters alone
    """

    finalists: Annotated[int, Field(ge=1, le=100)] = 6
    rounds: Annotated[int, Field(ge=0, le=10)] = 2
    further: Annotated[float, Field(ge=0, le=1)] = 0.25
    confidence: Annotated[float, Field(gt=0.5, le=1)] = 0.9
    alike: Annotated[float, Field(ge=0, le=1)] = 0.3
    iterations: Annotated[int, Field(ge=1, le=1000)] = 2
    patience: Annotated[int, Field(ge=1, le=1000)] = 6
    seed: Annotated[int, Field(ge=0)] = 0


@dataclass(frozen=True)
class Settings(Rules):
    """The rules, and what a caller chooses.

    floor      what builds of the machine differ by, as `floor_at` measures it: the smallest effect
               that counts, √(MSE before - MSE after) over the RMS effort; with an error no larger
               beside the sensor's noise a model counts as complete
    scale      of the robust loss, in the unit of the effort
    intervals  exact ones for the numbers of each rung; a trial of many robots does without
    always     look for effects, for a report to show, even where the whole error is below the
               floor and so none can count; a trial of many robots does without
    """

    floor: float = RESOLUTION
    scale: float = 0.05
    intervals: bool = True
    always: bool = True


@dataclass(frozen=True, eq=False)
class Confirmed:
    """Candidates after a full refit.

    effects  one, or a pair that helps only jointly
    missed   model minus measurement on the validation trials;  errors  its mean squares by block
    """

    effects: tuple[type[Effect], ...]
    gain: float
    fit: Fit
    missed: np.ndarray
    errors: np.ndarray
    scores: dict[str, Score]
    probability: float = 0.0


@dataclass(frozen=True)
class Rung:
    """One step of the ladder."""

    label: str
    effects: list[type[Effect]]
    fit: Fit
    scores: dict[str, Score]
    errors: np.ndarray


@dataclass
class Ladder:
    """Everything that the search saw; rounds[k] are the finalists of round k, best first.

    base   the fitted parameters alone, as they were when the search began
    floor  what builds of the machine differ by, where that was measured: of the machine with what
           was added, or of the one without any effect
    """

    base: Rung
    rungs: list[Rung]
    rounds: list[list[Confirmed]] = field(default_factory=list)
    screened: list[list[Screened]] = field(default_factory=list)
    vague: list[str] = field(default_factory=list)
    floor: Floor | None = None

    def settings(self, given: Settings) -> Settings:
        """The settings by which it is judged."""
        return replace(given, floor=self.floor.share) if self.floor else given


def builds_at(changes: Mapping[str, float], names: Sequence[str], scale: float) -> Builds:
    """Builds of a machine of our own design with these numbers, of which the named are fitted.

    scale  of the robust loss.  Lengths, mounts, drums, gears and the common place of the holes are
    none of its builds: what they change, the fitted numbers take up.
    """
    return Builds(changes, names, scale, {})


def floor_at(found: Fit, residuals: Mapping[str, Residual], scale: float) -> Floor:
    """The floor of a machine of our own design where these numbers were fitted."""
    builds = builds_at(found.changes, list(found.estimates), scale)
    return floor_of(residuals["train"], residuals["validate"], builds)


def weighed_at(
    changes: Mapping[str, float],
    names: Sequence[str],
    residuals: Mapping[str, Residual],
    scale: float,
) -> dict[str, Residual]:
    """The trials weighted by what builds of this machine differ by in them, by role."""
    right = complete(residuals["train"], RESOLUTION)
    return weighted(residuals, builds_at(changes, names, scale), right)


def parameters_of(effect: type[Effect]) -> list[str]:
    """Full names of an effect's numbers, its motors' differences included."""
    return [f"{effect.name()}.{f}" for f in [*effect.fitted(), *differences(effect)]]


def label(effects: Sequence[type[Effect]]) -> str:
    """Names of effects, "a + b"."""
    return " + ".join(e.name() for e in effects)


def rung_of(
    title: str, effects: list[type[Effect]], found: Fit, residuals: Mapping[str, Problem]
) -> Rung:
    scores, _, errors = scores_of(found, residuals)
    return Rung(title, effects, found, scores, errors)


def scores_of(
    found: Fit, residuals: Mapping[str, Problem]
) -> tuple[dict[str, Score], np.ndarray, np.ndarray]:
    """Scores by role; on the validation trials the residual, and its mean squares by block."""
    scores = {}
    missed = errors = np.zeros(0)
    for role in ROLES:
        residual = residuals[role]
        values = found.residual if role == "train" else residual(found.changes)
        measured = residual.measured()[residual.rows]
        scores[role] = score(measured, measured + values[residual.rows])
        if role == "validate":
            # a mean over samples of the effort, to which further signals only add
            missed = values / np.sqrt(np.mean(residual.rows))
            errors = block_errors(missed, residual.edges, residual.block)
    return scores, missed, errors


def missed_by(rung: Rung, problems: Mapping[str, Problem]) -> dict[str, np.ndarray]:
    """Model minus measurement by role, (N,) each."""
    others = {role: problems[role](rung.fit.changes) for role in ROLES if role != "train"}
    return {"train": rung.fit.residual, **others}


def line(scores: Mapping[str, Score], effort: Effort) -> str:
    return ", ".join(f"{role} RMSE {effort.shown(s.rmse)}" for role, s in scores.items())
