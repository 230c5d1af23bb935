"""What `diagnosis.json` holds, as types: of the arm, of any rig, of an arm logged elsewhere.

Written documents are checked before they are kept, read ones before they are believed.
`docs/diagnosis.schema.json` is the JSON schema of `Document`.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

FORMAT = 1  # counts up where a key changes its meaning or goes

Share = Annotated[float, Field(description="a share of one")]
Ends = tuple[float, float] | None  # of a 95 % interval; null where the data tell none
Roles = dict[str, float | None]


class Part(BaseModel):
    """A part of a document; an unknown key is an error."""

    model_config = ConfigDict(extra="forbid")


class Number(Part):
    """A fitted number with its 95 % interval, in SI or the rig's effort."""

    value: float
    low: float | None
    high: float | None
    unit: str


class Score(Part):
    """Errors of a model on one role of trials, in `unit`."""

    mae: float
    rmse: float
    r2: float | None


class Intervals(Part):
    """95 % intervals of a score."""

    mae: Ends
    rmse: Ends
    r2: Ends


class Sure(Part):
    """How sure a name is: `probability` that it is right, `together` that it or a rival is."""

    name: str
    probability: Share
    together: Share
    equivalents: list[str]
    rivals: list[str]


class Finding(Sure):
    """An effect that is named, or one of those between which nothing is decided."""

    title: str
    parameters: dict[str, Number]


class Evidence(Sure):
    """A chosen effect, named or not, with the figures behind its probability."""

    figures: dict[str, float]


class Candidate(Part):
    """An effect that was considered; errors of the best fitted model with it, null without one.

    `left_out_rmse` on data that no fit has seen, which decide; `with` is what the model holds
    besides; `alone_heldout_rmse` of the model with it alone; `screen_gain` what was promised.
    """

    model_config = ConfigDict(extra="forbid", populate_by_name=True)
    name: str
    title: str
    probability: Share
    heldout_rmse: float | None
    left_out_rmse: float | None
    train_rmse: float | None
    beside: list[str] = Field(alias="with")
    alone_heldout_rmse: float | None
    screen_gain: float


class Step(Part):
    """A model of the ladder: scores by role with intervals; `ceiling` marks the flexible one."""

    label: str
    effects: list[str]
    train: Score
    validate_: Score | None = Field(None, alias="validate")
    heldout: Score | None = None
    test: Score | None = None
    interval: dict[str, Intervals]
    ceiling: bool = False


class Left(Part):
    """What a flexible residual still explains: of the square, and by one signal alone."""

    share: Share
    alone: dict[str, float] | None = None


class Floor(Part):
    """What builds of an arm differ by, over the current, and how that was measured."""

    share: Share
    reason: str


class Regime(Part):
    """A part of the time, by what happens in it, and its part of the squared error."""

    kind: str
    regime: str
    share_of_error: Share
    share_of_time: Share
    bias: float
    rmse: float


class Wave(Part):
    """A wave of the residual, periods in a turn of `of`."""

    of: str
    order: float
    share_of_error: Share


class Lateness(Part):
    """What a delay [ms], or the command's rate, would explain of the residual."""

    delay_ms: float
    delay_share: float
    command_share: float | None


class Depends(Part):
    """What a residual depends on: in a sentence, and by one signal alone."""

    sentence: str
    alone: dict[str, float]


class Switch(Part):
    """A combination of candidates, fitted: RMSE by role, and by regime."""

    effects: list[str]
    how: str
    rmse: Roles
    regimes: Roles


class Nearest(Part):
    """The effect of the library that makes most of a composed law, and the share it makes."""

    name: str
    title: str
    share: float


class Law(Part):
    """A law that was composed for what no name explains."""

    file: str
    sentence: str
    shape: str
    formula: str
    terms: list[str]
    numbers: dict[str, Number]
    share: float
    rmse: Roles
    dissipative: bool
    nearest: Nearest
    range: dict[str, tuple[float, float]]


class Asked(Part):
    """What was played to decide, the sentence before, and whether it told nothing (`aside`)."""

    experiment: str
    before: str
    aside: bool = False


class Proof(Part):
    """A trial of its own: the share of its squared error that the name accounts for."""

    experiment: str
    share: float
    holds: bool


def told(text: str, of: str = "both") -> Any:
    """A key that only some documents have: of the `arm`, of a `rig`, or where there is one."""
    return Field(None, description=text, json_schema_extra={"of": of})


class Document(Part):
    """A diagnosis."""

    format: Literal[1] = Field(description="version of these keys")
    verdict: Literal["named", "undecided", "nothing_missing", "unknown"] = Field(
        description="what is said"
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

    Raises ValueError, naming the key, where it is none: a mistake of the program.
    """
    whole = {"format": FORMAT, **document}
    Document.model_validate(whole)
    return whole


def unknown(document: Mapping[str, Any]) -> str:
    """Why this is no document of ours, as the end of a sentence; empty where it is one."""
    if document.get("format") != FORMAT:
        told = f"format {document['format']!r}" if "format" in document else "no format"
        return f"it states {told}, where {FORMAT} is read; diagnose once more"
    try:
        Document.model_validate(document)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
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
