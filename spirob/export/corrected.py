"""The corrected model as `diagnosis.json` states it: what every target writes from.

Numbers and names come from a file that may be anybody's: each is checked here, and none becomes
code but through `translate`.
"""

import inspect
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from spirob.diagnosis.schema import read
from spirob.errors import DataError, ExportError
from spirob.export.law import Law, law_of
from spirob.machine.description.rig import NUMBERS
from spirob.machine.inverse.numbers import USUAL
from spirob.machine.laws import by_module

FORMAT = 1  # of `model` in a diagnosis


@dataclass(frozen=True)
class Held:
    """An effect of the model: its law and its numbers."""

    law: Law
    values: dict[str, float]

    @property
    def name(self) -> str:
        """The effect's name."""
        return self.law.name


@dataclass(frozen=True)
class Body:
    """The model file behind the motor; `drive` is the joint or tendon that the motor moves."""

    file: Path
    joint: str
    tendon: str
    tip: str
    others: tuple[str, ...]


@dataclass(frozen=True)
class Fitted:
    """Numbers that were fitted: `owner.field` -> value, with 95 % interval, bounds and unit.

    covariance  (n, n) in their own units, in the order of `names`; None where it is not known
    """

    names: tuple[str, ...]
    values: tuple[float, ...]
    intervals: tuple[tuple[float, float], ...]
    bounds: tuple[tuple[float, float], ...]
    units: tuple[str, ...]
    covariance: tuple[tuple[float, ...], ...] | None


@dataclass(frozen=True)
class Corrected:
    """A plain axis with what was fitted and named.

    axis      "rad" or "m";  effort, torque  units of the effort and of what it does
    numbers   those of `spirob.machine.description.rig.NUMBERS`
    angle     position for one radian of the motor;  rest_speed  below which it stands
    stiffness of the driven hinge, which some effects read
    period    of the held-out logs [s]
    usual     payload and offset, the mean of the logs: what is taken where nobody says
    own_inertia  of what moves ahead of the load that friction may feel; part of no load
    way       1 or -1 where the model was fitted to motions of this direction alone
    """

    name: str
    verdict: str
    sentence: str
    axis: str
    effort: str
    torque: str
    numbers: dict[str, float]
    angle: float
    rest_speed: float
    stiffness: float
    period: float
    effects: tuple[Held, ...]
    fitted: Fitted
    body: Body | None = None
    folder: Path = field(default_factory=Path)
    trials: tuple[dict[str, Any], ...] = ()
    usual: dict[str, float] = field(default_factory=lambda: dict.fromkeys(USUAL, 0.0))
    own_inertia: float = 0.0
    way: int = 0

    def at(self, port: str) -> list[Held]:
        """The effects at a port, in their order."""
        return [e for e in self.effects if e.law.port == port]


def read_document(path: Path) -> dict[str, Any]:
    """A diagnosis as plain data; raises ExportError where there is none."""
    try:
        return read(path)
    except DataError as error:
        raise ExportError(str(error)) from None


def require_sense(document: Mapping[str, Any], folder: Path) -> None:
    """Raise ExportError where a diagnosis says that its numbers describe no machine."""
    if document.get("doubts"):
        why = " ".join(str(document.get("explanation", "")).split())[:200]
        raise ExportError(
            f"{folder / 'diagnosis.json'}: has no verdict, so there is no model to take home: "
            f"data and model do not fit together. {why}".rstrip()
        )


def corrected(document: Mapping[str, Any], folder: Path) -> Corrected:
    """The model of a plain axis in a diagnosis that lies in `folder`.

    Raises ExportError where the diagnosis is of another version or found no sense in its data, or
    an effect's file is gone.
    """
    told = document.get("model")
    if not isinstance(told, Mapping) or told.get("format") != FORMAT:
        raise ExportError(
            f"{folder / 'diagnosis.json'}: was written by another version, which kept no model to "
            "take home; diagnose again"
        )
    try:
        require_sense(document, folder)
        return _read(document, told, folder)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        said = f"{type(error).__name__}: {error}"
        raise ExportError(
            f"{folder / 'diagnosis.json'}: its model cannot be read ({said[:120]}); diagnose again"
        ) from None


def _read(document: Mapping[str, Any], told: Mapping[str, Any], folder: Path) -> Corrected:
    body = told["body"]
    if told["axis"] not in ("rad", "m"):
        raise ValueError(f"axis '{told['axis']}'")
    return Corrected(
        str(document["rig"]),
        str(document["verdict"]),
        str(document["sentence"]),
        told["axis"],
        str(told["effort_unit"]),
        str(told["torque_unit"]),
        {name: finite(told["numbers"].get(name, 0.0)) for name in NUMBERS},
        finite(told["angle"]),
        finite(told["rest_speed"]),
        finite(told["stiffness"]),
        finite(told["period"]),
        tuple(held(one) for one in told["effects"]),
        fitted(told["fitted"]),
        None
        if body is None
        else Body(
            Path(body["file"]),
            str(body["joint"] or ""),
            str(body["tendon"] or ""),
            str(body["tip"] or ""),
            tuple(map(str, body["others"])),
        ),
        folder,
        tuple(told["trials"]),
        {kind: finite(told.get("usual", {}).get(kind, 0.0)) for kind in USUAL},
        way=round(finite(told.get("way", 0))),
    )


def finite(value: Any) -> float:
    """A number; raises ValueError where it is none or not finite."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{str(value)[:40]} is no number")
    return float(value)


def held(told: Mapping[str, Any]) -> Held:
    """An effect of a diagnosis, by the law that it was fitted with."""
    name = str(told["name"])
    law = law_in(name, str(told["source"]))
    values = {field: finite(told["numbers"][field]) for field in law.numbers}
    return Held(law, values)


def law_in(name: str, source: str) -> Law:
    """The law of an effect.

    source  module of an effect that the program knows, or path of a file of somebody's own
    Raises ExportError where it is gone; no module is imported because a diagnosis names it.
    """
    if source.endswith(".py"):
        path, effect = Path(source), None
    else:
        known = by_module()
        if source not in known:
            raise ExportError(f"effect '{name}': '{source}' is no effect of this version")
        effect = known[source]
        path = Path(inspect.getfile(effect))
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, ValueError):
        raise ExportError(
            f"effect '{name}': its file '{path}' is gone or unreadable; put it back, or diagnose "
            "again without it"
        ) from None
    return law_of(name, text, effect)


def fitted(told: Mapping[str, Any]) -> Fitted:
    """The fitted numbers of a diagnosis."""
    names = tuple(map(str, told["names"]))
    n = len(names)
    covariance = told["covariance"]
    if covariance is not None:
        covariance = tuple(tuple(finite(x) for x in row) for row in covariance)
        if len(covariance) != n or any(len(row) != n for row in covariance):
            raise ValueError("covariance of another size")
    found = Fitted(
        names,
        tuple(finite(x) for x in told["values"]),
        tuple((finite(a), finite(b)) for a, b in told["intervals"]),
        tuple((finite(a), finite(b)) for a, b in told["bounds"]),
        tuple(map(str, told["units"])),
        covariance,
    )
    if {len(found.values), len(found.intervals), len(found.bounds), len(found.units)} != {n}:
        raise ValueError("fitted numbers of different lengths")
    return found
