"""What `diagnosis.json` holds, as types: of the arm, of any rig, of an arm logged elsewhere.

Written documents are checked before they are kept, read ones before they are believed.
`docs/diagnosis.schema.json` is the JSON schema of `Document`.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from spirob.errors import DataError

FORMAT = 1  # counts up where a key changes its meaning or goes

LARGEST = 2**28  # bytes of a diagnosis
LONGEST = 80  # characters of what a foreign document states that a sentence can hold

Share = Annotated[float, Field(description="of one")]
Error = Annotated[float, Field(description="in `unit`")]
Fitted = Annotated[float | None, Field(description="in `unit`; null where nothing was fitted")]
R2 = Annotated[float | None, Field(description="of one; null where the measurement is constant")]
Name = Annotated[str, Field(description="by which the program knows it")]
Names = Annotated[list[str], Field(description="of effects")]
Title = Annotated[str, Field(description="in words")]
Trial = Annotated[str, Field(description="name of the experiment that was played")]
Says = Annotated[str, Field(description="a sentence")]
Ends = Annotated[
    list[float | None],
    Field(min_length=2, max_length=2, description="low and high; null where the data tell none"),
]
Range = Annotated[
    list[float], Field(min_length=2, max_length=2, description="lowest and highest value")
]
Roles = Annotated[dict[str, float | None], Field(description="in `unit`, by role of the trials")]
Signals = Annotated[dict[str, float], Field(description="a share of one for each signal")]


class Part(BaseModel):
    """A part of a document; an unknown key is an error, and so is a number in quotes."""

    model_config = ConfigDict(extra="forbid", strict=True)


class Number(Part):
    """A fitted number with its 95 % interval, in SI or the rig's effort."""

    value: float = Field(description="fitted, in the unit beside it")
    low: float | None = Field(description="end of its interval; null where there is none")
    high: float | None = Field(description="end of its interval; null where there is none")
    unit: str = Field(description="of the three")


class Score(Part):
    """Errors of a model on one role of trials, in `unit`."""

    mae: Error
    rmse: Error
    r2: R2


class Intervals(Part):
    """95 % intervals of a score."""

    mae: Ends
    rmse: Ends
    r2: Ends


class Sure(Part):
    """How sure a name is: `probability` that it is right, `together` that it or a rival is."""

    name: Name
    probability: Share
    together: Share
    equivalents: Names
    rivals: Names


class Finding(Sure):
    """An effect that is named, or one of those between which nothing is decided."""

    title: Title
    parameters: dict[str, Number] = Field(description="its fitted numbers")


class Evidence(Sure):
    """A chosen effect, named or not, with the figures behind its probability."""

    figures: dict[str, float] = Field(description="of `spirob.diagnosis.certainty`")


class Candidate(Part):
    """An effect that was considered; errors of the best fitted model with it, null without one.

    `left_out_rmse` on data that no fit has seen, which decide; `with` is what the model holds
    besides; `alone_heldout_rmse` of the model with it alone; `screen_gain` what was promised.
    """

    name: Name
    title: Title
    probability: Share
    heldout_rmse: Fitted
    left_out_rmse: Fitted
    train_rmse: Fitted
    beside: Names = Field(alias="with")
    alone_heldout_rmse: Fitted
    screen_gain: Share


class Step(Part):
    """A model of the ladder: scores by role with intervals; `ceiling` marks the flexible one."""

    label: Title
    effects: Names
    train: Score = Field(description="what is fitted")
    validate_: Score | None = Field(None, alias="validate", description="of the arm")
    heldout: Score | None = Field(None, description="of the arm")
    test: Score | None = Field(None, description="of a rig: held out")
    interval: dict[str, Intervals] = Field(description="of the same, by role")
    ceiling: bool = Field(False, description="no model of the machine")


class Left(Part):
    """What a flexible residual still explains: of the square, and by one signal alone."""

    share: Share
    alone: Signals | None = Field(None, description="a share of one for each signal; of a rig")


class Floor(Part):
    """What builds of an arm differ by, over the current, and how that was measured."""

    share: Share
    reason: Says


class Regime(Part):
    """A part of the time, by what happens in it, and its part of the squared error."""

    kind: str = Field(description="what it is about")
    regime: Title
    share_of_error: Share
    share_of_time: Share
    bias: Error
    rmse: Error


class Wave(Part):
    """A wave of the residual, periods in a turn of `of`."""

    of: str = Field(description="`motor`, `output` or `stroke`")
    order: float = Field(description="periods")
    share_of_error: Share


class Lateness(Part):
    """What a delay [ms], or the command's rate, would explain of the residual."""

    delay_ms: float = Field(description="ms, negative where the measurement is ahead")
    delay_share: Share
    command_share: float | None = Field(description="of one; null where no command was recorded")


class Depends(Part):
    """What a residual depends on: in a sentence, and by one signal alone."""

    sentence: Says
    alone: Signals


class Switch(Part):
    """A combination of candidates, fitted: RMSE by role, and by regime."""

    effects: Names
    how: str = Field(description="`base`, `verdict` or `refitted`")
    rmse: Roles
    regimes: dict[str, float | None] = Field(description="in `unit`, by regime")


class Nearest(Part):
    """The effect of the library that makes most of a composed law, and the share it makes."""

    name: Name
    title: Title
    share: Share


class Law(Part):
    """A law that was composed for what no name explains."""

    file: str = Field(description="of the effect, beside the document")
    sentence: Says
    shape: Title
    formula: str = Field(description="with its numbers")
    terms: list[str] = Field(description="kinds of its shapes, one entry a term")
    numbers: dict[str, Number] = Field(description="fitted")
    share: Share
    rmse: Roles
    dissipative: bool = Field(description="whether it can only brake")
    nearest: Nearest = Field(description="of the library")
    range: dict[str, Range] = Field(description="of each signal that it reads, that taught it")


class Asked(Part):
    """What was played to decide, the sentence before, and whether it told nothing (`aside`)."""

    experiment: Trial
    before: Says
    aside: bool = Field(False, description="it did not tell which")


class Proof(Part):
    """A trial of its own: the share of its squared error that the name accounts for."""

    experiment: Trial
    share: Share
    holds: bool = Field(description="whether the name stands")


def told(text: str, of: str = "both") -> Any:
    """A key that only some documents have: of the `arm`, of a `rig`, or where there is one."""
    return Field(None, description=text, json_schema_extra={"of": of})


class Document(Part):
    """A diagnosis."""

    format: Literal[1] = Field(description="version of these keys")
    verdict: Literal["named", "undecided", "nothing_missing", "unknown"] = Field(
        description="`named`, `undecided`, `nothing_missing` or `unknown`"
    )
    sentence: str = Field(description="the verdict in a line")
    explanation: str = Field(description="the same in a paragraph, with figures")
    doubts: list[str] = Field(
        description="why data and model do not fit together, a sentence each; then nothing is named"
    )
    next_experiment: str = Field(description="what would decide or make sure; may be empty")
    next_trials: list[dict[str, Any]] | None = told(
        "the proposed trials, to be added under `recordings.trials`", "arm"
    )
    effects: list[Finding] = Field(
        description="each named effect, or those between which nothing is decided, with numbers"
    )
    evidence: list[Evidence] = Field(
        description="each chosen effect, named or not, with the figures behind its probability"
    )
    candidates: list[Candidate] = Field(description="every effect that was considered")
    ladder: list[Step] = Field(description="the models and their errors")
    left: Left = Field(description="what the flexible residual still explains")
    noise_floor: float = Field(description="RMS of the sensor's noise, in `unit`")
    atlas: list[Regime] = Field(description="where the model without effects fails, by regime")
    atlas_sentences: list[str] = Field(description="the three worst regimes, in words")
    atlas_orders: list[Wave] = Field(description="waves over the turns of motor and gear")
    atlas_lateness: Lateness = Field(description="what a delay or the command would explain")
    depends: Depends | None = told("what the residual depends on", "arm")
    unit: str = Field(description="of effort and errors")
    floor: Floor | None = told("what builds of it differ by", "arm")
    vague: list[str] | None = told("numbers that the data do not tell without an effect", "arm")
    asked: Asked | None = told("what was played to decide")
    proof: Proof | None = told("what the name was worth in a trial of its own")
    composed: Law | None = told("the law for what no name explains")
    rig: str | None = told("its name", "rig")
    predict: str | None = told("what was compared: `effort`, `motion` or both", "rig")
    effort: str | None = told("name of the effort", "rig")
    effort_rms: Roles | None = told("RMS of the measured effort, by role", "rig")
    repairs: list[str] | None = told("what was repaired, left out or found odd", "rig")
    excluded: dict[str, str] | None = told("effects that cannot act on it, and why", "rig")
    numbers: dict[str, Number] | None = told("the fitted numbers", "rig")
    switches: list[Switch] | None = told("every combination of three candidates, fitted", "rig")
    model: dict[str, Any] | None = told("the model that stands, for export", "rig")
    motion: dict[str, Any] | None = told("errors of the motion run forward", "rig")


def checked(document: Mapping[str, Any]) -> dict[str, Any]:
    """A document that is about to be written, with its format.

    Raises AssertionError, naming the key, where it is none: a mistake of the program.
    """
    whole = {"format": FORMAT, **document}
    if why := unknown(whole):
        raise AssertionError(f"a diagnosis that no reader would know: {why}")
    return whole


def read(path: Path) -> dict[str, Any]:
    """A diagnosis as plain data; raises DataError in a sentence where there is none."""
    try:
        if path.stat().st_size > LARGEST:
            raise DataError(f"{path}: is too large for a diagnosis")
        found = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from None
    except (ValueError, RecursionError):
        raise DataError(f"{path}: is no diagnosis: no JSON") from None
    if not isinstance(found, dict) or "verdict" not in found:
        raise DataError(f"{path}: is no diagnosis: it states no verdict")
    if why := unknown(found):
        raise DataError(f"{path}: is no diagnosis of this version: {why}")
    return found


def unknown(document: Mapping[str, Any]) -> str:
    """Why this is no document of ours, as the end of a sentence; empty where it is one."""
    if document.get("format") != FORMAT:
        stated = repr(document["format"])[:LONGEST] if "format" in document else ""
        told = f"format {stated}" if stated else "no format"
        return f"it states {told}, where {FORMAT} is read; diagnose once more"
    try:
        Document.model_validate(document)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        place = ".".join(" ".join(str(part).split()) for part in first["loc"])[:LONGEST]
        return f"{place}: {first['msg'][:1].lower()}{first['msg'][1:]}"
    return ""


def keys() -> str:
    """The keys of a document as Markdown."""
    head = "| key | of | holds |\n|---|---|---|"
    rows = []
    for name, field in Document.model_fields.items():
        extra = field.json_schema_extra
        of = str(extra["of"]) if isinstance(extra, dict) else "both"
        rows.append(f"| `{name}` | {'' if of == 'both' else of} | {field.description} |")
    return "\n".join([head, *rows]) + "\n\n"
