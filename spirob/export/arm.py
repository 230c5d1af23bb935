"""The corrected arm: its numbers, effects and the trials kept aside, as the pipeline left them.

The diagnosis states an interval for each number.  How the numbers vary together, those of the
effects and all others, follows here from the trials that were fitted: slopes of the same residual,
and its covariance by blocks, to first order where the model stands.

Each of its motors is an axis in rotor coordinates, its load the tendon's torque (`motor_of`).
"""

import inspect
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from spirob.effects import Effect, all_effects
from spirob.effects.effect import SUFFIX, differences
from spirob.errors import ConfigError, ExportError, SpirobError
from spirob.export.axis import ADDED, BEFORE, CURRENT, FRAME, REPORT, SHARE
from spirob.export.corrected import Corrected, Fitted, Held, finite, require_sense
from spirob.export.law import law_of
from spirob.identify.descent import slopes_ahead
from spirob.identify.intervals import block_covariance
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Filter, Residual
from spirob.identify.scaling import Scaling
from spirob.logs import read_parquet
from spirob.logs.trace import read_table
from spirob.machine.arm.replay import again
from spirob.machine.description.rig import NUMBERS
from spirob.plant import Plant, Rig
from spirob.robot import MOTORS, Scene

BASE = "identified/base.json"
FILE = "heldout.parquet"
MODEL, CONFIG, TRACES = "model.json", "config/config.yaml", "traces"


@dataclass(frozen=True)
class CorrectedArm:
    """An arm with what was fitted and named.

    changes  numbers that are not those of the rig, `owner.field` -> value
    fitted   name -> value, low, high, unit, of the diagnosis
    correlation  of some of them, (name, name) -> value, of the fit before effects were added
    data     folder of the pipeline's data; None where the arm was logged elsewhere
    heldout  names of the trials kept aside in that data;  kept  those of an arm logged elsewhere
    """

    name: str
    verdict: str
    sentence: str
    rig: Rig
    effects: tuple[type[Effect], ...]
    changes: dict[str, float]
    fitted: dict[str, dict[str, Any]]
    data: Path | None
    heldout: tuple[str, ...]
    correlation: dict[tuple[str, str], float] = field(default_factory=dict)
    kept: tuple[Measurement, ...] = ()

    def plant(self) -> Plant:
        """The model itself."""
        return Plant(self.rig, self.effects)

    def trials(self) -> list[Measurement]:
        """The trials kept aside in which nothing is touched or hung on a winch.

        Raises ExportError where there is none.
        """
        every = list(self.kept)
        for name in self.heldout if self.data else ():
            path = self.data / TRACES / f"{name}.parquet"  # type: ignore[operator]
            try:
                every.append(Measurement.from_trace(read_parquet(path)))
            except (SpirobError, OSError) as error:
                raise ExportError(f"{path}: {error}") from None
        found = [t for t in every if t.scene == Scene() and t.schedule.held is None]
        if not found:
            raise ExportError(
                "no trial of the arm was kept aside in which it moves freely, so nothing can be "
                "played"
            )
        return found


def corrected_arm(document: dict[str, Any], folder: Path) -> CorrectedArm:
    """The arm of a diagnosis in `folder`.

    Raises ExportError where the diagnosis is of another version or something beside it is gone.
    """
    told = document.get("model")
    try:
        require_sense(document, folder)
        if isinstance(told, dict):
            if told.get("format") != 1 or told.get("machine") != "arm":
                raise ValueError("of another version")
            found = _arm(document, told, told["rig"], None, ())
            return replace(found, kept=_kept(folder / FILE, told.get("trials", [])))
        data = folder.parent
        told = json.loads(_text(folder / MODEL))
        config = yaml.safe_load(_text(data / CONFIG))
        trials = [t["name"] for t in config["recordings"]["trials"] if t["role"] == "heldout"]
        found = _arm(document, told, config["rig"], data, tuple(map(str, trials)))
        return _with_base(found, json.loads(_text(data / BASE)))
    except (KeyError, TypeError, ValueError, AttributeError, yaml.YAMLError) as error:
        raise ExportError(
            f"{folder / 'diagnosis.json'}: its model cannot be read ({str(error)[:100]}); it is of "
            "another version, or not whole: diagnose again"
        ) from None
    except ConfigError as error:
        raise ExportError(f"{folder / 'diagnosis.json'}: {error}") from None


def _arm(
    document: dict[str, Any],
    told: dict[str, Any],
    rig: dict[str, Any],
    data: Path | None,
    heldout: tuple[str, ...],
) -> CorrectedArm:
    known = all_effects()
    names = list(map(str, told["effects"]))
    if strange := [Path(name).stem for name in names if name not in known]:
        raise ExportError(
            f"effect '{strange[0]}' is none of the library; an arm takes home only those, so put "
            "its file there"
        )
    changes = {str(name): finite(value) for name, value in told["changes"].items()}
    made = Rig.from_mapping(rig)
    effects = tuple(known[name] for name in names)
    plant = Plant(made, effects)
    changes = {n: v for n, v in changes.items() if n in plant.table.names}
    numbers = {k: v for k, v in document.get("numbers", {}).items() if "." in k}
    for effect in document["effects"]:
        numbers |= {f"{effect['name']}.{f}": v for f, v in effect["parameters"].items()}
    return CorrectedArm(
        made.name,
        str(document["verdict"]),
        str(document["sentence"]),
        made,
        effects,
        changes,
        numbers,
        data,
        heldout,
    )


def _kept(path: Path, told: list[dict[str, Any]]) -> tuple[Measurement, ...]:
    """The trials kept aside of an arm that was logged elsewhere; none where they are gone."""
    if not path.is_file():
        return ()
    try:
        return tuple(again(read_table(path), told))
    except (KeyError, TypeError, ValueError, OSError) as error:
        raise ExportError(f"{path}: cannot be read ({str(error)[:100]}); diagnose again") from None


def _with_base(model: CorrectedArm, base: dict[str, Any]) -> CorrectedArm:
    """The arm with the numbers that were fitted before an effect was added.

    Values are those of the model that stands; their intervals keep the widths of that fit.
    """
    fitted = {}
    for name, told in base["parameters"].items():
        value, before = model.changes.get(name, told["value"]), finite(told["value"])
        ends = {end: value + finite(told[end]) - before for end in ("low", "high")}
        fitted[name] = {"value": value, **ends, "unit": told["unit"]}
    told = base.get("resolution") or {"names": [], "correlation": []}
    pairs = {
        (a, b): finite(told["correlation"][i][j])
        for i, a in enumerate(told["names"])
        for j, b in enumerate(told["names"])
    }
    return replace(model, fitted={**fitted, **model.fitted}, correlation=pairs)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise ExportError(f"{path}: {error.strerror}; diagnose again") from None


STEP = 0.01  # of a scaled number
TRAIN = "train"


def correlation_of(model: CorrectedArm, names: Sequence[str]) -> np.ndarray | None:
    """Correlation of these numbers, (n, n); None where the trials that were fitted are not there.

    A number that the trials do not tell correlates with none.
    """
    residual, scale = _residual(model) or (None, 0.0)
    if residual is None or not names:
        return None
    scaling, table = Scaling(residual.table, names), residual.table
    own = {n: model.changes.get(n, float(table.values[table.position(n)])) for n in names}
    fixed = {n: v for n, v in model.changes.items() if n not in own}
    u = scaling.scaled(own)
    value = residual({**fixed, **scaling.physical(u)})
    slopes = slopes_ahead(residual, scaling, u, fixed, value, STEP)
    covariance = block_covariance(slopes, value, residual.edges, scale, residual.block)
    covariance = scaling.slopes(u) @ covariance @ scaling.slopes(u).T
    deviation = np.sqrt(np.diag(covariance))
    known = np.isfinite(deviation) & (deviation > 0.0)
    deviation = np.where(known, deviation, 1.0)
    found = np.where(np.outer(known, known), covariance / np.outer(deviation, deviation), 0.0)
    np.fill_diagonal(found, 1.0)
    return np.asarray(np.clip(found, -1.0, 1.0))


def _residual(model: CorrectedArm) -> tuple[Residual, float] | None:
    """The residual of the trials that were fitted, and the scale of its robust loss [A]."""
    if model.data is None:
        return None
    try:
        config = yaml.safe_load((model.data / CONFIG).read_text(encoding="utf-8"))
        said = config["identify"]
        names = [t["name"] for t in config["recordings"]["trials"] if t["role"] == TRAIN]
        trials = [
            Measurement.from_trace(read_parquet(model.data / TRACES / f"{name}.parquet"))
            for name in names
        ]
        settings = Filter(**said["filter"]), str(said["current"]), float(said["length"])
        scale = float(said["scale"])
    except (SpirobError, OSError, KeyError, TypeError, ValueError, yaml.YAMLError):
        return None
    return (Residual(model.plant(), trials, *settings), scale) if trials else None


OF_A_MOTOR = {*ADDED, *BEFORE, CURRENT, FRAME, REPORT, SHARE}
CYCLE = 1e-3  # s


def lever_of(model: CorrectedArm, motor: str) -> float:
    """Tendon that a motor winds in for one radian of its rotor [m]."""
    number = number_of(model, motor)
    return number("winch.radius", True) / number("winch.gear_ratio")


def reported_lever(model: CorrectedArm) -> float:
    """The same as the drives report it, which know nothing of their drums' differences [m]."""
    return model.rig.winch.radius / number_of(model, MOTORS[0])("winch.gear_ratio")


def number_of(model: CorrectedArm, motor: str) -> Callable[..., float]:
    """The numbers of the arm by name, on request as they differ at one motor."""
    plant = model.plant()
    p = plant.table.vector(model.changes)
    side = 1.0 if motor == MOTORS[0] else -1.0

    def number(name: str, differs: bool = False) -> float:
        own = float(p[plant.table.position(name)])
        if not differs:
            return own
        return own * (1.0 + side * float(p[plant.table.position(f"{name}_difference")]))

    return number


def motor_of(model: CorrectedArm, motor: str) -> Corrected:
    """One motor as an axis: rotor angle, current, and as `carried` the tendon's torque r·F/G."""
    number, lever = number_of(model, motor), lever_of(model, motor)
    gear = number("winch.gear_ratio")
    efficiency = number("winch.efficiency", True)
    numbers = dict.fromkeys(NUMBERS, 0.0) | {
        "viscous": number("motor.rotor_damping", True),
        "scale": efficiency * number("motor.torque_constant"),
    }
    effects = [e for e in held_by(model, motor) if e.law.port in OF_A_MOTOR]
    pulled = [
        replace(e, values={"force": e.values["force"] * lever})
        if e.law.port == "tendon.force" and set(e.values) == {"force"}
        else e
        for e in effects
    ]
    return Corrected(
        f"{model.name} {motor}",
        model.verdict,
        model.sentence,
        "rad",
        "A",
        "N·m",
        numbers,
        1.0,
        number("motor.rest_speed"),
        0.0,
        CYCLE,
        tuple(e for e in pulled if e.law.port != "tendon.force" or set(e.values) == {"force"}),
        Fitted((), (), (), (), (), None),
        own_inertia=number("motor.rotor_inertia", True) + number("winch.drum_inertia") / gear**2,
    )


def held_by(model: CorrectedArm, motor: str) -> list[Held]:
    """The effects with the numbers that they have at one motor."""
    plant = model.plant()
    p = plant.table.vector(model.changes)
    side = 1.0 if motor == MOTORS[0] else -1.0
    found = []
    for effect in model.effects:
        text = inspect.getsource(inspect.getmodule(effect))  # type: ignore[arg-type]
        law = law_of(effect.name(), text, effect)
        values = {}
        for n in law.numbers:
            values[n] = float(p[plant.table.position(f"{effect.name()}.{n}")])
            if n + SUFFIX in differences(effect):
                own = p[plant.table.position(f"{effect.name()}.{n}{SUFFIX}")]
                values[n] += side * float(own)
        found.append(Held(law, values))
    return found
